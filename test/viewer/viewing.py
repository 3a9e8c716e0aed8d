"""What tests of the viewer share."""

import asyncio
import json
import re
import struct
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager

import aiohttp
from observing import NodeProcess

from circle_bounce_ros.viewer.server import Server

PATIENCE = 60.0  # s; only a fault takes that long
CLOSE = aiohttp.WSMsgType.CLOSE
VIEWER = ('-m', 'circle_bounce_ros.viewer.main')


def address_of(viewer):
    """Return what the viewer says its address is, once it does."""
    deadline = time.monotonic() + PATIENCE
    while not (found := re.search(r'http://127\.0\.0\.1:\d+', viewer.log)):
        assert viewer.process.poll() is None, viewer.log
        assert time.monotonic() < deadline, f'no address within {PATIENCE} s: {viewer.log}'
        # Without a pause this would take a core from what starts.
        time.sleep(0.02)
    return found[0]


class Stage:
    """A node and a viewer that several tests share, because each takes seconds to start."""

    def __init__(self, folder):
        self._folder = folder
        self._count = 0
        self.node = self.viewer = self.address = None

    def _log(self):
        self._count += 1
        return self._folder / f'log{self._count}'

    def start_node(self, *arguments):
        self.node = NodeProcess(self._log(), *arguments)

    def start_viewer(self):
        port = self.address.rpartition(':')[2] if self.address else 0
        self.viewer = NodeProcess(self._log(), '-p', f'port:={port}', program=VIEWER)
        self.address = address_of(self.viewer)

    def end(self):
        end_all([self.viewer, self.node])
        assert 'Traceback' not in self.viewer.log, self.viewer.log


def end_all(processes):
    """End processes as Ctrl-C does; each must end with status 0."""
    for process in processes:
        if process.process.poll() is None:
            try:
                status = process.end()
            finally:
                if process.process.poll() is None:
                    process.process.kill()
                    process.wait()
            assert status == 0, process.log


class ProtocolClient:
    """A page without a browser: speaks what the page speaks."""

    def __init__(self, socket):
        self.socket = socket
        self.texts = []

    async def say(self, **message):
        await self.socket.send_str(json.dumps(message))

    async def next(self, within=PATIENCE):
        """Return the next message: a dict for text, (kind, number, time, rest) for a frame."""
        message = await self.socket.receive(timeout=within)
        if message.type is aiohttp.WSMsgType.TEXT:
            said = json.loads(message.data)
            self.texts.append(said)
            return said
        assert message.type is aiohttp.WSMsgType.BINARY, message
        kind, number, length = struct.unpack_from('<III', message.data)
        end = 12 + length + -length % 4
        return kind, number, message.data[12 : 12 + length], message.data[end:]

    async def frame(self, within=PATIENCE):
        """Return the next frame of bodies."""
        return await self.until(lambda m: isinstance(m, tuple) and m[0] == 1, within)

    async def said(self, **parts):
        """Return the next text with these parts."""
        return await self.until(lambda m: isinstance(m, dict) and parts.items() <= m.items())

    async def goodbye(self):
        """Return the code with which the other side closes."""
        while (message := await self.socket.receive(timeout=PATIENCE)).type is not CLOSE:
            assert message.type in (aiohttp.WSMsgType.TEXT, aiohttp.WSMsgType.BINARY)
        return message.data

    async def until(self, is_it, within=PATIENCE):
        deadline = time.monotonic() + within
        while True:
            message = await self.next(max(0.01, deadline - time.monotonic()))
            if is_it(message):
                return message


@asynccontextmanager
async def connected(address, **headers):
    """`async with connected(address) as page`: a ProtocolClient."""
    async with (
        aiohttp.ClientSession() as session,
        session.ws_connect(
            f'{address}/socket', headers={'Origin': address} | headers, max_msg_size=0
        ) as socket,
    ):
        yield ProtocolClient(socket)


class Nowhere:
    """What the server asks of its RosLink, without ROS."""

    port = 0
    node_name, bodies_topic = '/bounce', '/bodies'

    def __init__(self):
        self.wanted = asyncio.Queue()
        self.logged = []

    def want_contacts(self, wanted):
        self.wanted.put_nowait(wanted)

    def publishers(self):
        return []

    async def ask(self, request):
        return f'done: {request["type"]}'

    def log(self, text):
        self.logged.append(text)


@asynccontextmanager
async def serving(**options):
    """`async with serving() as (server, link, address)`: the viewer's server in this process, without ROS."""
    server, link = Server(**options), Nowhere()
    address, _ = await server.start(link)
    try:
        yield server, link, address
    finally:
        await server.stop()


def run(work):
    """Return what a coroutine returns, in a thread of its own: in this one a loop of Playwright may be running."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, asyncio.wait_for(work, 3 * PATIENCE)).result()
