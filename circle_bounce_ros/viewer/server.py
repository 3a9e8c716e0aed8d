"""The HTTP side: the page's own files and one web socket, for this machine only."""

from __future__ import annotations

import asyncio
import json
import socket
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

from aiohttp import WSCloseCode, WSMsgType, web

from circle_bounce_ros.scene_file import scene_names
from circle_bounce_ros.viewer.clients import Client, Frames
from circle_bounce_ros.viewer.contacts import Contacts
from circle_bounce_ros.viewer.messages import LARGEST_MESSAGE, MessageError, read
from circle_bounce_ros.viewer.ros_link import Refusal, RosLink

LOOPBACK = '127.0.0.1'
PORTS = 9  # tried one after the other
MOST_CLIENTS = 32
MOST_REQUESTS = 8  # of one page, at a time
STATUS_PERIOD = 1.0  # s
HEARTBEAT = 20.0  # s

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

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


def bind(port: int) -> tuple[socket.socket, list[int]]:
    """
    Return a listening socket on the first free port from this one, and the ports found in use.

    Raises
    ------
    OSError
        When there is none.

    """
    in_use = []
    for candidate in range(port, port + PORTS) if port else [0]:
        bound = socket.socket()
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            bound.bind((LOOPBACK, candidate))
            bound.listen()
        except OSError:
            bound.close()
            in_use.append(candidate)
        else:
            return bound, in_use
    raise OSError(f'ports {port} to {port + PORTS - 1} of {LOOPBACK} are all in use')


class Server:
    """Serves the page, and hands on what is heard."""

    def __init__(self) -> None:
        self._frames = Frames()
        self._clients: set[Client] = set()
        self._diagnostics: dict[str, Any] | None = None
        self._tasks: set[asyncio.Task[None]] = set()
        self._unreadable: set[str] = (
            set()
        )  # channels on which something came that nobody understands
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
        bound, in_use = bind(link.port)
        port = bound.getsockname()[1]
        hosts = {f'{name}:{port}' for name in (LOOPBACK, 'localhost')}
        if port == 80:
            hosts |= {LOOPBACK, 'localhost'}
        app = web.Application(middlewares=[only_this_machine(hosts)], client_max_size=1024)
        app.router.add_get('/socket', self._socket)
        app.router.add_get('/{path:.*}', self._file)
        self._runner = web.AppRunner(app, access_log=None, shutdown_timeout=1.0)
        await self._runner.setup()
        await web.SockSite(self._runner, bound).start()
        self._begin(self._tell_status())
        return f'http://{LOOPBACK}:{port}', in_use

    async def stop(self) -> None:
        """Close the pages' sockets, then everything else."""
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
        try:
            self._take(channel, message)
        except ValueError as error:
            # Somebody else's message: once is enough, it comes sixty times a second.
            if channel not in self._unreadable:
                self._link.log(f'{channel}: cannot be read: {error}')
            self._unreadable.add(channel)

    def _take(self, channel: str, message: Any) -> None:
        frames = self._frames
        if channel == 'time':
            frames.see_time(message)
        elif channel == 'bodies':
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
        return {'type': 'status', 'publishers': self._link.count_publishers()}

    async def _file(self, request: web.Request) -> web.Response:
        # A name that is in the table, or none: no path is ever made from what was asked for.
        found = self._files.get(request.raw_path)
        if found is None:
            raise web.HTTPNotFound(headers=HEADERS)
        body, kind = found
        return web.Response(body=body, content_type=kind, charset='utf-8', headers=HEADERS)

    async def _socket(self, request: web.Request) -> web.StreamResponse:
        if len(self._clients) >= MOST_CLIENTS:
            raise web.HTTPServiceUnavailable(text=f'{MOST_CLIENTS} pages look on already')
        # Compression would cost four times the work and save nothing on one machine.
        page = web.WebSocketResponse(
            compress=False, max_msg_size=LARGEST_MESSAGE, heartbeat=HEARTBEAT
        )
        await page.prepare(request)
        client = Client(page, self._frames)
        self._greet(client)
        self._clients.add(client)
        sending = self._begin(client.serve())
        requests: set[asyncio.Task[None]] = set()
        try:
            async for message in page:
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
            self._clients.discard(client)
            self._watch()
        return page

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


def only_this_machine(hosts: set[str]) -> Any:
    """
    Return a middleware that refuses what did not come to one of these hosts, from one of their pages.

    Another site's page can send requests here, and its name can be made to point here; then Origin or Host is
    its own.
    """
    origins = {f'http://{host}' for host in hosts}

    @web.middleware
    async def check(request: web.Request, handler: Handler) -> web.StreamResponse:
        named = request.headers.getall('Host', [])
        origin = request.headers.getall('Origin', [])
        is_page = len(origin) == 1 and origin[0] in origins
        if len(named) != 1 or named[0] not in hosts:
            raise web.HTTPForbidden(text='403: this host name is not served')
        # A browser names the origin of every web socket.
        if not is_page and (origin or request.path == '/socket'):
            raise web.HTTPForbidden(text='403: this origin is not served')
        return await handler(request)

    return check
