"""Open connections, before HTTP: how many there may be, and how long each may keep one without use."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import cast

# A page has one web socket, and a browser up to six connections more while it loads.
MOST_CONNECTIONS = 128
# For a whole request, and again for the next one. A web socket may stay silent, but must take what it is sent.
PATIENCE = 15.0  # s
LARGEST_REQUEST = 2**15  # bytes


class Connections:
    """
    Makes the protocols of connections that come in and ends those that only take up room.

    Parameters
    ----------
    make : callable
        Returns the protocol that serves one connection.
    say : callable
        Called with a sentence when a connection had to make room for another.
    most : int
        At a time; for one more the one that has been silent longest is closed.
    patience : float, s

    """

    def __init__(
        self,
        make: Callable[[], asyncio.Protocol],
        say: Callable[[str], None],
        most: int = MOST_CONNECTIONS,
        patience: float = PATIENCE,
    ) -> None:
        self._make = make
        self._say = say
        self._most = most
        self.patience = patience
        # Oldest use first; web sockets are in `_all` only.
        self._waiting: dict[asyncio.BaseTransport | None, _Connection] = {}
        self._all: dict[asyncio.BaseTransport | None, _Connection] = {}

    def __call__(self) -> asyncio.Protocol:
        """Return the protocol of a new connection."""
        return _Connection(self._make(), self)

    def use(self, transport: asyncio.BaseTransport | None) -> None:
        """Take note that a whole request has come, or that a web socket has ended: patience begins anew."""
        if (connection := self._all.get(transport)) is not None:
            self._waiting.pop(transport, None)
            self._waiting[transport] = connection
            connection.await_request()

    def keep(self, transport: asyncio.BaseTransport | None) -> None:
        """Take note that a connection has become a web socket."""
        if (connection := self._waiting.pop(transport, None)) is not None:
            connection.await_nothing()

    def add(self, connection: _Connection) -> None:
        self._all[connection.transport] = connection
        self.use(connection.transport)
        if len(self._all) > self._most:
            self._say(
                f'connections: at most {self._most} at a time; the one that was silent longest is closed'
            )
            next(iter(self._waiting.values())).end()

    def remove(self, connection: _Connection) -> None:
        self._all.pop(connection.transport, None)
        self._waiting.pop(connection.transport, None)


class _Connection(asyncio.Protocol):
    """A protocol that hands everything on to the one that serves, and watches time and size."""

    transport: asyncio.Transport

    def __init__(self, served: asyncio.Protocol, connections: Connections) -> None:
        self._served = served
        self._connections = connections
        self._request: asyncio.TimerHandle | None = None  # the end of patience with a request
        self._stall: asyncio.TimerHandle | None = None  # the same with a reader that does not read
        self._size = 0  # of the request that is not whole yet, bytes

    def await_request(self) -> None:
        self.await_nothing()
        self._size = 0
        loop = asyncio.get_running_loop()
        self._request = loop.call_later(self._connections.patience, self.end)

    def await_nothing(self) -> None:
        if self._request is not None:
            self._request.cancel()
            self._request = None

    def end(self) -> None:
        # To close would wait for a reader that does not read.
        self.transport.abort()
        self._connections.remove(self)

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport = cast(asyncio.Transport, transport)
        self._served.connection_made(transport)
        self._connections.add(self)

    def data_received(self, data: bytes) -> None:
        if self._request is not None:
            self._size += len(data)
            if self._size > LARGEST_REQUEST:
                self.end()
                return
        self._served.data_received(data)

    def eof_received(self) -> bool | None:
        return self._served.eof_received()

    def pause_writing(self) -> None:
        self._served.pause_writing()
        self._look_at_reader(self.transport.get_write_buffer_size() + 1)

    def _look_at_reader(self, before: int) -> None:
        unsent = self.transport.get_write_buffer_size()
        if unsent >= before:
            self.end()
        else:
            loop = asyncio.get_running_loop()
            self._stall = loop.call_later(self._connections.patience, self._look_at_reader, unsent)

    def resume_writing(self) -> None:
        self._rest()
        self._served.resume_writing()

    def _rest(self) -> None:
        if self._stall is not None:
            self._stall.cancel()
            self._stall = None

    def connection_lost(self, exc: Exception | None) -> None:
        self._rest()
        self.await_nothing()
        self._connections.remove(self)
        self._served.connection_lost(exc)
