"""What the viewer says to pages, and how its process begins and ends, without a browser."""

import asyncio
import socket
import time
from urllib.parse import urlsplit

import numpy as np
import pytest
from observing import NodeProcess
from sensor_msgs.msg import PointCloud2
from viewing import VIEWER, address_of, connected, end_all, run

from circle_bounce_ros.viewer.access import PORTS
from circle_bounce_ros.viewer.cloud import read_cloud

# What pages get


def test_a_page_gets_the_bytes_that_the_node_has_published(play, stage, observer):
    play()
    heard = []
    observer.node.create_subscription(PointCloud2, 'bodies', heard.append, 100, raw=True)

    async def look():
        async with connected(stage.address) as page:
            frames = []
            while len(frames) < 20:
                frames.append(await page.frame())
                await page.say(type='ack', frame=frames[-1][1])
            return frames

    # The observer's own executor is not spun meanwhile: its queue keeps the last 100 messages.
    observer.collect(heard, 1)
    frames = run(look())
    wanted = {rest for *_, rest in frames[-5:]}
    observer.spin_until(lambda: wanted <= set(heard), 'the same bytes')
    # With each state comes the scene time of the same stamp.
    assert all(time_message[4:12] == rest[4:12] for *_, time_message, rest in frames[-5:])


def test_a_page_that_does_not_draw_gets_one_frame_and_then_the_newest(play, stage):
    play()

    async def look():
        async with connected(stage.address) as slow, connected(stage.address) as quick:
            _, first, *_ = await slow.frame()
            for _ in range(30):
                _, newest, *_ = await quick.frame()
                await quick.say(type='ack', frame=newest)
            with pytest.raises(asyncio.TimeoutError):
                await slow.frame(within=0.2)
            await slow.say(type='ack', frame=first)
            _, second, *_ = await slow.frame()
            assert second >= newest

    run(look())


def test_a_page_cannot_ask_for_more_by_acknowledging_what_it_never_got(play, stage):
    play()

    async def look():
        async with connected(stage.address) as page:
            await page.frame()
            await page.say(type='ack', frame=2**53 - 1)
            await page.frame()
            with pytest.raises(asyncio.TimeoutError):
                await page.frame(within=0.2)

    run(look())


def test_ten_pages_are_kept_up_to_date_with_10_000_circles(play, stage, many):
    play(many)
    newest = 0

    async def draw_frames():
        nonlocal newest
        behind = []
        async with connected(stage.address) as page:
            while len(behind) < 20:
                _, number, _, message = await page.frame()
                await page.say(type='ack', frame=number)
                newest = max(newest, number)
                if read_cloud(message).points.size == 10000:
                    behind.append(newest - number)
        return behind

    async def look():
        return await asyncio.gather(*(draw_frames() for _ in range(10)))

    # Nobody gets a frame that is older than what another had, but for the few that are on their way at the same time.
    # How fast they come, benchmarks/viewer.py measures on a machine that does nothing else.
    assert np.median(run(look())) <= 1


def test_a_node_of_another_name_and_namespace_is_watched_and_asked(domain, tmp_path):
    node = NodeProcess(tmp_path / 'node', '-r', '__node:=other', '-r', '__ns:=/here')
    viewer = NodeProcess(
        tmp_path / 'viewer',
        '-p',
        'port:=0',
        '-p',
        'node:=other',
        '-r',
        '__ns:=/here',
        program=VIEWER,
    )

    async def look():
        async with connected(address_of(viewer)) as page:
            hello = await page.said(type='hello')
            assert (hello['node'], hello['topic']) == ('/here/other', '/here/bodies')
            await page.frame()
            report = await page.said(type='diagnostics')
            assert report['values']['scene'] == 'lesson'
            # Discovery of a service may take longer than that of a topic.
            while True:
                await page.say(type='pause', paused=True)
                if (await page.said(type='answer', to='pause'))['done']:
                    break
            while (await page.said(type='diagnostics'))['values']['paused'] != 'true':
                pass

    try:
        run(look())
    finally:
        end_all([viewer, node])


def test_contacts_are_subscribed_to_only_while_a_circle_is_selected(play, stage, observer):
    play()

    async def look():
        async with connected(stage.address) as page:
            await page.frame()
            # Pages of other tests may have closed just now.
            observer.spin_until(
                lambda: observer.node.count_subscribers('contacts') == 0, 'nobody listens'
            )
            await page.say(type='select', circle=0)
            story = await page.said(type='contacts')
            assert story['circle'] == 0
            # Discovery may tell this subscriber later than the node.
            observer.spin_until(
                lambda: observer.node.count_subscribers('contacts') == 1,
                'a subscription to contacts',
            )
            await page.say(type='select', circle=-1)

    run(look())
    observer.spin_until(
        lambda: observer.node.count_subscribers('contacts') == 0, 'no subscription to contacts'
    )


def test_whoever_selects_last_gets_contacts_however_quickly_it_changes(play, stage):
    play()

    async def look():
        async with connected(stage.address) as page:
            for _ in range(5):
                # Both are read at once, and what they ask for waits side by side.
                await page.say(type='select', circle=0)
                await page.say(type='select', circle=-1)
                await page.say(type='select', circle=0)
                await page.said(type='contacts')
                await page.say(type='select', circle=-1)

    run(look())


def test_an_answer_says_in_words_what_the_node_has_refused(play, stage):
    play()

    async def look():
        async with connected(stage.address) as page:
            await page.said(type='hello')
            await page.frame()
            await page.say(type='step')
            answer = await page.said(type='answer', to='step')
            assert not answer['done']
            assert 'pause' in answer['text']
            await page.say(type='scene', scene='nowhere', seed=-1)
            answer = await page.said(type='answer', to='scene')
            assert not answer['done']
            assert 'must be one of billiard, break' in answer['text']

    run(look())


def test_without_a_node_the_answer_says_so(lone_viewer):
    async def look():
        async with connected(lone_viewer) as page:
            status = await page.said(type='status')
            assert status['publishers'] == []
            await page.say(type='reset')
            answer = await page.said(type='answer')
            assert not answer['done']
            assert 'is the node running' in answer['text']

    run(look())


# The process


def test_a_port_in_use_makes_it_take_the_next_one_and_say_so(domain, tmp_path):
    with socket.socket() as taken:
        taken.bind(('127.0.0.1', 0))
        taken.listen()
        port = taken.getsockname()[1]
        viewer = NodeProcess(tmp_path / 'log', '-p', f'port:={port}', program=VIEWER)
        try:
            assert port < urlsplit(address_of(viewer)).port < port + PORTS
            assert f'port {port}' in viewer.log
        finally:
            end_all([viewer])


def test_without_a_free_port_it_ends_with_a_sentence(domain, tmp_path):
    taken = []
    try:
        port = 20000
        while len(taken) < PORTS:
            taken.append(socket.socket())
            try:
                taken[-1].bind(('127.0.0.1', port + len(taken) - 1))
                taken[-1].listen()
            except OSError:
                port += len(taken)
                while taken:
                    taken.pop().close()
        viewer = NodeProcess(tmp_path / 'log', '-p', f'port:={port}', program=VIEWER)
        assert viewer.wait() == 1
        assert f'bounce_viewer: ports {port} to {port + 8} of 127.0.0.1' in viewer.log
        assert 'Traceback' not in viewer.log
    finally:
        for each in taken:
            each.close()


def test_ctrl_c_ends_it_with_pages_open(stage):

    async def look():
        async with connected(stage.address) as page:
            await page.frame()
            began = time.monotonic()
            status = await asyncio.to_thread(stage.viewer.end)
            # Pages that do not say goodbye, as this one does not, cannot hold it up.
            assert time.monotonic() - began < 10.0
            assert status == 0

    try:
        run(look())
    finally:
        if stage.viewer.process.poll() is not None:
            stage.start_viewer()
