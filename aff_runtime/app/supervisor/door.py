"""The second socket: who looks on gets the ring and the facts, and is never listened to.

It parses nothing. A visitor that says anything is told so and sent away; one that does not take
its packets misses them, and goes when it has taken none for a while. Packets are whole or not
there, so there is nothing to buffer and no half line.
"""

from __future__ import annotations

import os
import selectors
import socket
from collections.abc import Callable
from pathlib import Path

from aff_runtime import __version__
from aff_runtime.app.door.messages import (
    DoorMessage,
    Facts,
    Hello,
    RingGone,
    RingPassed,
    SentAway,
    encode,
)
from aff_runtime.app.link.peer import peer_of, uids_with
from aff_runtime.app.supervisor.packet_listener import listening
from aff_runtime.base.ports import Clock
from aff_runtime.base.socket_file import identity, remove_own
from aff_runtime.telemetry.ring import RingReader

VIEWER = "aff-hmi"
MAX_VISITORS = 8
FACTS_NS = 500_000_000
HURRY_NS = 50_000_000
PATIENCE_NS = 10_000_000_000
_ANOTHER = "name another folder with --door-dir"


class Visitor:
    """One who looks on.

    Attributes
    ----------
    ring : the ring that it was told of. ``heard_ns`` : when it last took a packet.
    """

    def __init__(self, connection: socket.socket, now_ns: int) -> None:
        connection.setblocking(False)
        self.connection = connection
        self.ring: RingReader | None = None
        self.heard_ns = now_ns

    def tell(self, message: DoorMessage, descriptor: int | None = None) -> bool:
        """Send one packet, whole or not at all; False when it was not taken."""
        passed = [] if descriptor is None else [descriptor]
        try:
            socket.send_fds(self.connection, [encode(message)], passed)
        except OSError:
            return False
        return True


class Door:
    """Listens at ``door.sock`` in a folder.

    Parameters
    ----------
    folder : the runtime directory, or one that is opened to the group of the screens.
    is_private : the socket is for our own user alone.

    Raises
    ------
    RefusedError
        When no socket can be made there, others may write there, or another service uses it.
    """

    def __init__(
        self, folder: Path, selector: selectors.BaseSelector, clock: Clock, *, is_private: bool
    ) -> None:
        self._path = folder / "door.sock"
        self._selector = selector
        self._clock = clock
        self._told_ns = -HURRY_NS
        self._facts_due_ns = 0
        self._visitors: dict[int, Visitor] = {}
        self._listener = listening(
            self._path, 0o600 if is_private else 0o660, MAX_VISITORS, _ANOTHER
        )
        self._made = identity(self._path)
        selector.register(self._listener, selectors.EVENT_READ)

    def serve(self, key: selectors.SelectorKey) -> bool:
        """Do what a selector's event asks for; False when it is none of the door's."""
        if key.fileobj is self._listener:
            self._let_in()
        elif isinstance(key.data, Visitor):
            if self._visitors.get(key.fd) is key.data:
                self._turn_away(key.data)
        else:
            return False
        return True

    def hurry(self) -> None:
        """Tell the facts soon: something has changed that a screen shows, or somebody came.

        In this round, unless they were told a moment ago: a flood costs no more than that.
        """
        self._facts_due_ns = self._told_ns + HURRY_NS

    def step(self, ring: RingReader | None, facts: Callable[[], Facts]) -> None:
        """Tell every visitor of a new ring, and of the facts when they are due."""
        if not self._visitors:
            return
        now_ns = self._clock.now_ns()
        for visitor in [v for v in self._visitors.values() if v.ring is not ring]:
            if self._tell_ring(visitor, ring):
                visitor.ring = ring
        if now_ns < self._facts_due_ns:
            return
        self._told_ns, self._facts_due_ns = now_ns, now_ns + FACTS_NS
        said = facts()
        for visitor in list(self._visitors.values()):
            if visitor.tell(said):
                visitor.heard_ns = now_ns
            elif now_ns > visitor.heard_ns + PATIENCE_NS:
                self._drop(visitor)

    def close(self) -> None:
        """Close the door and remove the socket."""
        for visitor in list(self._visitors.values()):
            self._drop(visitor)
        self._listener.close()
        remove_own(self._path, self._made)

    def _let_in(self) -> None:
        """Take one visitor; when there are too many, the one who came first goes."""
        try:
            connection, _ = self._listener.accept()
        except OSError:
            return
        if peer_of(connection).uid not in viewer_uids():
            connection.close()
            return
        visitor = Visitor(connection, self._clock.now_ns())
        self._visitors[connection.fileno()] = visitor
        self._selector.register(connection, selectors.EVENT_READ, visitor)
        visitor.tell(Hello(version=__version__))
        visitor.tell(RingGone())
        self.hurry()
        if len(self._visitors) > MAX_VISITORS:
            self._drop(next(iter(self._visitors.values())))

    def _turn_away(self, visitor: Visitor) -> None:
        """Let go of a visitor that has left, or that says something; what, is not looked at."""
        try:
            has_left = not visitor.connection.recv(1)
        except BlockingIOError:
            return
        except OSError:
            has_left = True
        if not has_left:
            visitor.tell(SentAway())
        self._drop(visitor)

    @staticmethod
    def _tell_ring(visitor: Visitor, ring: RingReader | None) -> bool:
        """Pass a descriptor of the visitor's own, which reads and cannot write."""
        if ring is None:
            return visitor.tell(RingGone())
        try:
            passed = os.open(f"/dev/fd/{ring.fileno()}", os.O_RDONLY | os.O_CLOEXEC)
        except OSError:
            return False
        try:
            return visitor.tell(RingPassed(), passed)
        finally:
            os.close(passed)

    def _drop(self, visitor: Visitor) -> None:
        self._visitors.pop(visitor.connection.fileno(), None)
        self._selector.unregister(visitor.connection)
        visitor.connection.close()


def viewer_uids() -> frozenset[int]:
    """Return who may look on: root, ourselves, and the screen's own user where there is one."""
    return uids_with(VIEWER)
