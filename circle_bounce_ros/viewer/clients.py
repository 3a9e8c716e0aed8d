"""The pages that look on: each gets the newest frame once it has drawn the one before."""

from __future__ import annotations

import asyncio
import json
import struct
import time
from collections import OrderedDict, deque
from typing import Any

from aiohttp import WSCloseCode, web

from circle_bounce_ros.viewer.cloud import stamp_of

# The kinds of binary frames, and what goes before the messages in them:
# kind, number of the frame, length of the first message (the second follows, at the next multiple of 4).
BODIES, STATIC = 1, 2
HEAD = struct.Struct('<III')

KEPT_TIMES = 16
MOST_TEXTS = 256  # waiting for one page; a page that does not read loses the oldest


class Frames:
    """
    The newest state that came, ready to be sent.

    Attributes
    ----------
    number : int
        How many have come.
    bodies, static : bytes or None
        Serialized, as they came.

    """

    def __init__(self) -> None:
        self.number = 0
        self.bodies: bytes | None = None
        self.static: bytes | None = None
        self._stamp = 0  # ns, of the bodies
        self._times: OrderedDict[int, bytes] = OrderedDict()

    def see_time(self, message: bytes) -> None:
        """Take note of the scene time of a tick."""
        self._times[stamp_of(message)] = message
        while len(self._times) > KEPT_TIMES:
            self._times.popitem(last=False)

    def see_bodies(self, message: bytes) -> None:
        """Take note of the state at a tick."""
        self._stamp = stamp_of(message)
        self.bodies = message
        self.number += 1

    def bodies_frame(self) -> bytes:
        """Return the newest state, behind the scene time of the same stamp if that has come."""
        assert self.bodies is not None
        time = self._times.get(self._stamp, b'')
        padding = bytes(-len(time) % 4)
        return b''.join((HEAD.pack(BODIES, self.number, len(time)), time, padding, self.bodies))

    def static_frame(self) -> bytes:
        """Return the walls and locked circles."""
        assert self.static is not None
        return HEAD.pack(STATIC, 0, 0) + self.static


class Client:
    """
    One page.

    It has one frame in flight: the next one is sent when the page says that it has drawn that one,
    and is then the newest there is. So a page that is slow misses frames and does not lag.

    Parameters
    ----------
    socket : WebSocketResponse
    frames : Frames

    """

    def __init__(self, socket: web.WebSocketResponse, frames: Frames) -> None:
        self.circle = -1
        self.heard = time.monotonic()  # s, when the page said something
        self._socket = socket
        self._frames = frames
        self._texts: deque[str] = deque(maxlen=MOST_TEXTS)
        self._wake = asyncio.Event()
        self._sent = self._drawn = 0
        self._static: bytes | None = None

    def tell(self, text: str) -> None:
        """Send a text soon."""
        self._texts.append(text)
        self._wake.set()

    def say(self, **message: Any) -> None:
        """Send a message soon."""
        self.tell(json.dumps(message))

    def wake(self) -> None:
        """Look whether there is something new to be sent."""
        self._wake.set()

    def drew(self, frame: int) -> None:
        """Take note that the page is done with a frame."""
        self._drawn = max(self._drawn, min(frame, self._sent))
        self._wake.set()

    async def serve(self) -> None:
        """Send what there is until the page has gone."""
        frames = self._frames
        try:
            while True:
                await self._wake.wait()
                self._wake.clear()
                while self._texts:
                    await self._socket.send_str(self._texts.popleft())
                if frames.static is not None and frames.static is not self._static:
                    self._static = frames.static
                    await self._socket.send_bytes(frames.static_frame())
                if frames.number > self._sent == self._drawn:
                    self._sent = frames.number
                    await self._socket.send_bytes(frames.bodies_frame())
        except ConnectionError:
            pass

    async def close(
        self, code: WSCloseCode = WSCloseCode.GOING_AWAY, reason: bytes = b'the viewer ends'
    ) -> None:
        """Say goodbye."""
        if self._socket.prepared:
            await self._socket.close(code=code, message=reason)
