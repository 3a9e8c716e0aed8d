"""The HTTP side: the page's own files and one web socket, for this machine only."""

from __future__ import annotations

import asyncio
import json
import time
from pathlib import Path
from typing import Any

from aiohttp import WSCloseCode, WSMsgType, web

from circle_bounce_ros.encoding.clouds import BODY
from circle_bounce_ros.scene_file import scene_names
from circle_bounce_ros.viewer.access import LOOPBACK, Handler, bind, only_this_machine
from circle_bounce_ros.viewer.clients import Client, Frames
from circle_bounce_ros.viewer.cloud import check_points, read_cloud
from circle_bounce_ros.viewer.connections import PATIENCE, Connections
from circle_bounce_ros.viewer.contacts import Contacts
from circle_bounce_ros.viewer.messages import LARGEST_MESSAGE, MessageError, read
from circle_bounce_ros.viewer.ros_link import Refusal, RosLink
from circle_bounce_ros.viewer.seldom import SeldomLog, http_log, one_line

MOST_CLIENTS = 32
QUIET = 10.0  # s without a word after which a page makes room for another; one that draws speaks all the time
MOST_REQUESTS = 8  # of one page, at a time
STATUS_PERIOD = 1.0  # s
HEARTBEAT = 20.0  # s

# What a page reads of `bodies`.
NEEDED = ('x', 'y', 'vx', 'vy', 'radius', 'id')

PAGE = Path(__file__).parent / 'page'
TYPES = {
    '.html': 'text/html',
    '.css': 'text/css',
    '.js': 'text/javascript',
    '.svg': 'image/svg+xml',
}
HEADERS = {
    'Content-Security-Policy': "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    'Cross-Origin-Opener-Policy': 'same-origin',
    'Cross-Origin-Resource-Policy': 'same-origin',
    'Referrer-Policy': 'no-referrer',
    'X-Content-Type-Options': 'nosniff',
    # A page of an older version would not understand what a newer viewer says.
    'Cache-Control': 'no-store',
}


class Server:
    """
    Serves the page, and hands on what is heard.

    Parameters
    ----------
    patience : float, s
        With connections that ask for nothing, or do not read.
    quiet : float, s
        Without a word, after which a page makes room for another.

    """

    def __init__(self, patience: float = PATIENCE, quiet: float = QUIET) -> None:
        self._patience = patience
        self._quiet = quiet
        self._frames = Frames()
        self._clients: set[Client] = set()
        self._diagnostics: dict[str, Any] | None = None
        self._tasks: set[asyncio.Task[None]] = set()
        self._faults: dict[str, str] = {}  # what is wrong with the last message, by channel
        self._files = {
            f'/{path.name}': (path.read_bytes(), TYPES[path.suffix])
            for path in sorted(PAGE.iterdir())
            if path.suffix in TYPES
        }
        self._files['/'] = self._files['/index.html']

    async def start(self, link: RosLink) -> tuple[str, list[int]]:
        """
        Begin to serve.

        Parameters
        ----------
        link : RosLink
            Where to ask for what the pages' buttons say.

        Returns
        -------
        str
            The address.
        list of int
            The ports that were in use.

        """
        self._link = link
        self._log = SeldomLog(link.log)
        bound, in_use = bind(link.port)
        port = bound.getsockname()[1]
        hosts = {f'{name}:{port}' for name in (LOOPBACK, 'localhost')}
        if port == 80:
            hosts |= {LOOPBACK, 'localhost'}
        app = web.Application(
            middlewares=[self._take_note, only_this_machine(hosts)], client_max_size=1024
        )
        app.router.add_get('/socket', self._socket)
        app.router.add_get('/{path:.*}', self._file)
        self._runner = web.AppRunner(
            app, access_log=None, logger=http_log(self._log), shutdown_timeout=1.0
        )
        await self._runner.setup()
        assert self._runner.server is not None
        self._connections = Connections(self._runner.server, self._log, patience=self._patience)
        loop = asyncio.get_running_loop()
        self._listening = await loop.create_server(self._connections, sock=bound)
        self._begin(self._tell_status())
        return f'http://{LOOPBACK}:{port}', in_use

    async def stop(self) -> None:
        """Close the pages' sockets, then everything else."""
        self._listening.close()
        await asyncio.gather(*(client.close() for client in set(self._clients)))
        for task in set(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        await self._runner.cleanup()

    def _begin(self, work: Any) -> asyncio.Task[None]:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task

    def hear(self, channel: str, message: Any) -> None:
        """Take note of what came on a channel of the RosLink, and hand it on."""
        before = self._faults.pop(channel, None)
        try:
            self._take(channel, message)
        except ValueError as error:
            # Somebody else's message, and it comes sixty times a second.
            fault = one_line(str(error))
            self._log(f'{channel}: cannot be read: {fault}')
            self._faults[channel] = fault
        if (self._faults.get(channel) is None) != (before is None):
            self._tell_all(json.dumps(self._status()))

    def _take(self, channel: str, message: Any) -> None:
        frames = self._frames
        if channel == 'time':
            frames.see_time(message)
        elif channel == 'bodies':
            check_points(read_cloud(message).points, BODY, NEEDED)
            frames.see_bodies(message)
        elif channel == 'static':
            frames.static = message
        elif channel == 'diagnostics':
            self._diagnostics = message
            self._tell_all(json.dumps({'type': 'diagnostics', **message}))
        elif channel == 'contacts':
            self._tell_contacts(message)
        if channel in ('bodies', 'static'):
            for client in self._clients:
                client.wake()

    def _tell_contacts(self, message: bytes) -> None:
        contacts = Contacts(message)
        for client in self._clients:
            if client.circle >= 0 and (own := contacts.of(client.circle)):
                client.say(type='contacts', circle=client.circle, contacts=own)

    def _tell_all(self, text: str) -> None:
        for client in self._clients:
            client.tell(text)

    async def _tell_status(self) -> None:
        while True:
            await asyncio.sleep(STATUS_PERIOD)
            if self._clients:
                self._tell_all(json.dumps(self._status()))

    def _status(self) -> dict[str, Any]:
        return {
            'type': 'status',
            'publishers': self._link.publishers(),
            'faults': self._faults,
        }

    @web.middleware
    async def _take_note(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        self._connections.use(request.transport)
        return await handler(request)

    async def _file(self, request: web.Request) -> web.Response:
        # A name that is in the table, or none: no path is ever made from what was asked for.
        found = self._files.get(request.raw_path)
        if found is None:
            raise web.HTTPNotFound(headers=HEADERS)
        body, kind = found
        return web.Response(body=body, content_type=kind, charset='utf-8', headers=HEADERS)

    async def _socket(self, request: web.Request) -> web.StreamResponse:
        if len(self._clients) >= MOST_CLIENTS and not self._make_room():
            raise web.HTTPServiceUnavailable(text=f'{MOST_CLIENTS} pages look on already')
        # Compression would cost four times the work and save nothing on one machine.
        page = web.WebSocketResponse(
            compress=False, max_msg_size=LARGEST_MESSAGE, heartbeat=HEARTBEAT
        )
        client = Client(page, self._frames)
        # Before the next one can come: to prepare takes a while.
        self._clients.add(client)
        try:
            await page.prepare(request)
            self._connections.keep(request.transport)
            self._greet(client)
            await self._converse(client, page)
        finally:
            self._clients.discard(client)
            self._watch()
            self._connections.use(request.transport)
        return page

    async def _converse(self, client: Client, page: web.WebSocketResponse) -> None:
        sending = self._begin(client.serve())
        requests: set[asyncio.Task[None]] = set()
        try:
            async for message in page:
                client.heard = time.monotonic()
                if message.type is not WSMsgType.TEXT:
                    await refuse(page, 'text only')
                    break
                try:
                    wanted = read(message.data)
                except MessageError as error:
                    await refuse(page, str(error))
                    break
                self._obey(client, wanted, requests)
        finally:
            sending.cancel()

    def _make_room(self) -> bool:
        """Send the page away that has been silent longest, if it has been for long; return whether there was one."""
        quietest = min(self._clients, key=lambda client: client.heard)
        if time.monotonic() - quietest.heard < self._quiet:
            return False
        self._clients.discard(quietest)
        self._begin(quietest.close(WSCloseCode.TRY_AGAIN_LATER, b'another page looks on'))
        return True

    def _greet(self, client: Client) -> None:
        client.say(
            type='hello',
            node=self._link.node_name,
            topic=self._link.bodies_topic,
            scenes=scene_names(),
        )
        client.say(**self._status())
        if self._diagnostics is not None:
            client.say(type='diagnostics', **self._diagnostics)

    def _obey(
        self, client: Client, wanted: dict[str, Any], requests: set[asyncio.Task[None]]
    ) -> None:
        if wanted['type'] == 'ack':
            client.drew(wanted['frame'])
        elif wanted['type'] == 'select':
            client.circle = wanted['circle']
            self._watch()
        elif len(requests) >= MOST_REQUESTS:
            client.say(
                type='answer', to=wanted['type'], done=False, text='too many requests at once'
            )
        else:
            task = self._begin(self._ask(client, wanted))
            requests.add(task)
            task.add_done_callback(requests.discard)

    def _watch(self) -> None:
        is_wanted = any(client.circle >= 0 for client in self._clients)
        self._link.want_contacts(is_wanted)

    async def _ask(self, client: Client, wanted: dict[str, Any]) -> None:
        try:
            text, done = await self._link.ask(wanted), True
        except Refusal as reason:
            text, done = str(reason), False
        client.say(type='answer', to=wanted['type'], done=done, text=text)


async def refuse(page: web.WebSocketResponse, reason: str) -> None:
    """Close a socket that said something that no page says."""
    # The protocol has room for 123 bytes.
    await page.close(code=WSCloseCode.POLICY_VIOLATION, message=reason.encode()[:123])
