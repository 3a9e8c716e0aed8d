"""Whoever opens connections and does nothing with them keeps nobody out, and does not fill the log."""

import asyncio
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from urllib.parse import urlsplit

import aiohttp
import numpy as np
import pytest
from aiohttp import WSCloseCode
from viewing import PATIENCE, connected, run, serving

from circle_bounce_ros.encoding import BodiesEncoder
from circle_bounce_ros.viewer.connections import LARGEST_REQUEST, MOST_CONNECTIONS
from circle_bounce_ros.viewer.server import MOST_CLIENTS

LONG = 1000.0  # s: for ever, in a test
SHORT = 0.05  # s


@asynccontextmanager
async def raw(address, sent=b''):
    """`async with raw(address) as reader`: a connection that has sent so much."""
    place = urlsplit(address)
    reader, writer = await asyncio.open_connection(place.hostname, place.port)
    try:
        writer.write(sent)
        yield reader
    finally:
        writer.close()
        with suppress(ConnectionError):
            await writer.wait_closed()


async def is_ended(reader):
    """Wait until the other side has ended a connection, and return what it sent before."""
    got = b''
    try:
        while part := await asyncio.wait_for(reader.read(2**20), PATIENCE):
            got += part
    except ConnectionError:
        pass
    return got


async def status_of(address):
    async with aiohttp.ClientSession() as session, session.get(address) as answer:
        return answer.status


def test_connections_that_ask_for_nothing_keep_nobody_out():
    # Several times as many as there may be, and fewer than the files that a process may usually open.
    many = 5 * MOST_CONNECTIONS

    async def look():
        async with (
            serving(patience=LONG) as (_, link, address),
            connected(address) as page,
            AsyncExitStack() as idle,
        ):
            # Some of them half-way through a request.
            ends = [
                await idle.enter_async_context(raw(address, sent))
                for sent in [b'', b'GET / HTTP/1.1\r\n'] * (many // 2)
            ]
            assert await status_of(address) == 200
            # The oldest had to go; and the web socket is no such connection, although it is older.
            for reader in ends[: many - MOST_CONNECTIONS]:
                await is_ended(reader)
            await page.say(type='reset')
            await page.said(type='answer')
            assert [line.partition(':')[0] for line in link.logged] == ['connections']

    run(look())


@pytest.mark.parametrize(
    'sent',
    [b'', b'GET / HTTP/1.1\r\nHost: a', b'GET / HTTP/1.1\r\nHost: {host}\r\n\r\n'],
    ids=['nothing', 'half a request', 'a whole request'],
)
def test_a_connection_without_a_further_request_is_ended(sent):
    async def look():
        async with serving(patience=SHORT) as (_, _, address):
            request = sent.replace(b'{host}', address[7:].encode())
            async with raw(address, request) as reader:
                got = await is_ended(reader)
            assert got.startswith(b'HTTP/1.1 200' if b'{host}' in sent else b'')

    run(look())


def test_a_request_without_end_is_ended_however_quickly_it_comes():
    async def look():
        async with serving(patience=LONG) as (_, _, address):
            line = b'X-Much: ' + b'x' * 1000 + b'\r\n'
            much = b'GET / HTTP/1.1\r\n' + line * (LARGEST_REQUEST // len(line) + 1)
            async with raw(address, much) as reader:
                await is_ended(reader)

    run(look())


def test_what_is_no_http_is_said_once_and_in_words(capfd):
    async def look():
        async with serving() as (_, link, address):
            for garbage in (b'\x16\x03\x01\r\n\r\n', b'GET / HTTP/7\r\n\r\n', b'\0\r\n\r\n'):
                async with raw(address, garbage) as reader:
                    assert b' 400 ' in (await is_ended(reader)).partition(b'\n')[0]
            (line,) = link.logged
            assert line.startswith('request: cannot be read: ')

    run(look())
    assert capfd.readouterr().err == ''


def test_who_does_not_read_is_ended_and_its_place_is_free():
    many = 200_000  # circles: more bytes than the sockets' buffers take
    message = BodiesEncoder('world', range(many), [0.1] * many, [1.0] * many).encode(
        1, np.zeros((many, 2)), np.zeros((many, 2))
    )

    async def look():
        async with AsyncExitStack() as ends:
            server, link, address = await ends.enter_async_context(serving(patience=SHORT))
            reader = await ends.enter_async_context(raw(address, upgrade_to(address)))
            assert (await reader.readline()).startswith(b'HTTP/1.1 101 ')
            # From here on it takes no more than its own buffer holds.
            server.hear('bodies', message)
            # The server looks whether contacts are still wanted whenever a page has gone.
            assert await asyncio.wait_for(link.wanted.get(), PATIENCE) is False

    run(look())


def upgrade_to(address):
    """Return what a browser sends to open a web socket."""
    headers = {
        'Host': urlsplit(address).netloc,
        'Origin': address,
        'Upgrade': 'websocket',
        'Connection': 'Upgrade',
        'Sec-WebSocket-Version': '13',
        'Sec-WebSocket-Key': 'AAAAAAAAAAAAAAAAAAAAAA==',
    }
    lines = [f'{name}: {value}' for name, value in headers.items()]
    return '\r\n'.join(['GET /socket HTTP/1.1', *lines, '', '']).encode()


def test_pages_that_are_silent_for_long_make_room_and_others_do_not():
    async def fill(pages, address):
        return [await pages.enter_async_context(connected(address)) for _ in range(MOST_CLIENTS)]

    async def look():
        async with serving(quiet=LONG) as (_, _, address), AsyncExitStack() as pages:
            await fill(pages, address)
            with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
                await pages.enter_async_context(connected(address))
            assert refused.value.status == 503
        async with serving(quiet=1e-9) as (_, _, address), AsyncExitStack() as pages:
            first, second, *_ = await fill(pages, address)
            # The first one draws: it is heard of.
            await first.say(type='ack', frame=0)
            await first.say(type='reset')
            await first.said(type='answer')
            await (await pages.enter_async_context(connected(address))).said(type='hello')
            # aiohttp 3.9 lets its own goodbye come first.
            assert await second.goodbye() in (WSCloseCode.TRY_AGAIN_LATER, WSCloseCode.OK)
            await first.say(type='reset')
            await first.said(type='answer')

    run(look())
