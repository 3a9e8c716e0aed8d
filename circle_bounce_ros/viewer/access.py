"""Who gets in: this machine only, and only the viewer's own page."""

from __future__ import annotations

import socket
from collections.abc import Awaitable, Callable
from typing import Any

from aiohttp import web

LOOPBACK = '127.0.0.1'
PORTS = 9  # tried one after the other

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
