"""Our end of the pipe to a worker process: messages in and out without ever waiting for it.

A worker that is stopped has taken half of its orders, or sent half of an answer.
multiprocessing's own calls wait for the other half for ever, whatever limit the job has.
"""

from __future__ import annotations

import os
import selectors
import struct
from collections import deque
from collections.abc import Iterable
from multiprocessing.connection import Connection

_CHUNK_BYTES = 1 << 20
_LONGEST_SHORT = 0x7FFFFFFF  # of messages with a head of four bytes, as multiprocessing has them


class WorkerPipe:
    """Whole messages over a pipe whose other end multiprocessing reads and writes.

    Attributes
    ----------
    has_ended : the other end is closed; what had come is still there.
    """

    def __init__(self, pipe: Connection) -> None:
        os.set_blocking(pipe.fileno(), False)
        self._pipe = pipe
        self._unsent: deque[memoryview] = deque()
        self._heard = bytearray()
        self.has_ended = False

    def fileno(self) -> int:
        """Return the descriptor, for a selector."""
        return self._pipe.fileno()

    @property
    def owes(self) -> bool:
        """Whether there is more to be sent."""
        return bool(self._unsent) and not self.has_ended

    def send(self, message: bytes) -> None:
        """Send one message, as much of it as is taken now; `exchange` sends the rest."""
        size = len(message)
        long = size > _LONGEST_SHORT
        head = struct.pack("!iQ", -1, size) if long else struct.pack("!i", size)
        self._unsent += (memoryview(head), memoryview(message))
        self.exchange()

    def exchange(self) -> None:
        """Send what is taken now, and take what has come."""
        try:
            while self._unsent:
                sent = os.write(self.fileno(), self._unsent[0])
                part = self._unsent.popleft()
                if sent < len(part):
                    self._unsent.appendleft(part[sent:])
        except BlockingIOError:
            pass
        except OSError:
            self._unsent.clear()  # the end of the pipe says it
        try:
            while chunk := os.read(self.fileno(), _CHUNK_BYTES):
                self._heard += chunk
            self.has_ended = True
        except BlockingIOError:
            pass
        except OSError:
            self.has_ended = True

    @property
    def has_message(self) -> bool:
        """Whether a whole message has come that nobody has taken yet."""
        size, begin = self._size()
        return size is not None and len(self._heard) >= begin + size

    def message(self) -> bytes | None:
        """Return the next message that is whole, None while there is none."""
        size, begin = self._size()
        if size is None or len(self._heard) < begin + size:
            return None
        found = bytes(memoryview(self._heard)[begin : begin + size])
        self._heard = self._heard[begin + size :]
        return found

    def close(self) -> None:
        """Close this end."""
        self._pipe.close()

    def _size(self) -> tuple[int | None, int]:
        """Return the size of the message that comes, None while unknown, and where it begins."""
        if len(self._heard) < 4:
            return None, 0
        size: int = struct.unpack_from("!i", self._heard)[0]
        if size >= 0:
            return size, 4
        long = struct.unpack_from("!Q", self._heard, 4)[0] if len(self._heard) >= 12 else None
        return long, 12


def wait(pipes: Iterable[WorkerPipe], patience_s: float) -> None:
    """Wait until a worker says something, ends, or takes more of what it is owed.

    Sending a job may already have heard its answer, when a busy machine let the worker go first:
    the descriptor shows no more of it.
    """
    pipes = list(pipes)
    if any(pipe.has_message or pipe.has_ended for pipe in pipes):
        return
    with selectors.DefaultSelector() as selector:
        for pipe in pipes:
            writes = selectors.EVENT_WRITE if pipe.owes else 0
            selector.register(pipe, selectors.EVENT_READ | writes)
        selector.select(patience_s)
