"""The launcher of `make run`: node and page start together and end together."""

import http.client
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from installs import PATIENCE, ROOT

from circle_bounce_ros.installation import child_environment


@pytest.fixture
def start(domain, tmp_path):
    """Return a function that starts the launcher and returns it and what it says so far."""
    started = []

    def start(*arguments):
        log = tmp_path / f'log{len(started)}'
        with log.open('w') as output:
            command = [sys.executable, '-S', 'tools/run.py', '--ros-args', *arguments]
            started.append(
                subprocess.Popen(
                    command, cwd=ROOT, env=child_environment(), stdout=output, stderr=output
                )
            )
        return started[-1], log.read_text

    yield start
    for process in started:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
            process.wait(PATIENCE)


def children_of(process):
    listed = subprocess.check_output(['ps', '-o', 'pid=', '--ppid', str(process.pid)], text=True)
    return [int(pid) for pid in listed.split()]


def is_running(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def wait_for(condition):
    deadline = time.monotonic() + PATIENCE
    while not (result := condition()):
        assert time.monotonic() < deadline
    return result


@pytest.mark.parametrize('by', [signal.SIGINT, signal.SIGTERM])
def test_one_signal_ends_node_and_page_with_status_0(start, by):
    process, said = start('-p', 'port:=0')
    found = wait_for(lambda: re.search(r'http://(127\.0\.0\.1):(\d+)', said()))
    wait_for(lambda: "scene 'lesson'" in said())
    connection = http.client.HTTPConnection(found[1], int(found[2]), timeout=PATIENCE)
    connection.request('GET', '/')
    response = connection.getresponse()
    assert response.status == 200
    assert b'<title>Circle bounce</title>' in response.read()
    connection.close()
    children = children_of(process)
    assert len(children) == 2
    process.send_signal(by)
    assert process.wait(PATIENCE) == 0
    assert not any(is_running(pid) for pid in children)
    assert 'Traceback' not in said()


def test_the_node_has_shared_memory_for_the_messages_of_many_circles(start):
    process, said = start('-p', 'port:=0')
    wait_for(lambda: "scene 'lesson'" in said())
    node = next(
        pid
        for pid in children_of(process)
        if 'bounce_node' in Path(f'/proc/{pid}/cmdline').read_text()
    )
    maps = Path(f'/proc/{node}/maps').read_text().splitlines()
    ends = [line.split()[0].split('-') for line in maps if '/dev/shm/fastrtps_' in line]
    # Of 0.5 MiB, which is usual, a tick of 10,000 circles takes more than all.
    assert max(int(end, 16) - int(begin, 16) for begin, end in ends) >= 2**24


def test_when_the_node_cannot_start_the_page_ends_too(start):
    process, said = start('-p', 'port:=0', '-p', 'scene:=nowhere')
    assert process.wait(PATIENCE) == 1
    assert "got 'nowhere'" in said()
