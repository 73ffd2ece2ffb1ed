"""The door, a socket beside that of requests: who looks on gets ring and facts, and no hearing.

It parses nothing. A visitor that sends anything gets ``SentAway`` and is dropped; one that does
not take its packets misses them, and goes when it has taken none for a while. Packets are whole
or not there, so there is nothing to buffer and no half line.
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
from aff_runtime.app.link.peer import Peer, uids_with
from aff_runtime.app.supervisor.packet_listener import SCREEN_USER, PacketSocket, Visitor
from aff_runtime.base.ports import Clock
from aff_runtime.telemetry.ring import RingReader

MAX_VISITORS = 8  # one more, and the one who came first goes
FACTS_NS = 500_000_000  # between two packets of facts
HURRY_NS = 50_000_000  # the same when something has changed
PATIENCE_NS = 10_000_000_000  # with a visitor that takes no packet
_ANOTHER = "name another folder with --door-dir"


class Onlooker(Visitor):
    """One who looks on.

    Attributes
    ----------
    ring : the ring whose descriptor it has.
    took_ns : when it last took the facts; at first, when it came.
    """

    def __init__(self, connection: socket.socket, peer: Peer, now_ns: int) -> None:
        super().__init__(connection, peer)
        self.ring: RingReader | None = None
        self.took_ns = now_ns

    def tell(self, message: DoorMessage, descriptor: int | None = None) -> bool:
        """Send one packet, whole or not at all; False when it was not taken."""
        passed = [] if descriptor is None else [descriptor]
        try:
            socket.send_fds(self.connection, [encode(message)], passed)
        except OSError:
            return False
        return True


class Door(PacketSocket[Onlooker]):
    """Listens at ``door.sock`` in a folder: the runtime directory, or one for the screens."""

    KIND = Onlooker
    MOST = MAX_VISITORS

    def __init__(
        self, folder: Path, selector: selectors.BaseSelector, clock: Clock, *, is_private: bool
    ) -> None:
        self._clock = clock
        self._sent_ns = -HURRY_NS
        self._facts_due_ns = 0
        super().__init__(folder / "door.sock", selector, _ANOTHER, is_private=is_private)

    def hurry(self) -> None:
        """Send the facts soon: something has changed that a screen shows, or somebody came.

        In this round, or ``HURRY_NS`` after the last ones: a flood of changes costs one packet in
        that time.
        """
        self._facts_due_ns = self._sent_ns + HURRY_NS

    def step(self, ring: RingReader | None, facts: Callable[[], Facts]) -> None:
        """Pass a new ring to every visitor, and send the facts when they are due."""
        if not self._visitors:
            return
        now_ns = self._clock.now_ns()
        for visitor in [v for v in self._visitors.values() if v.ring is not ring]:
            if self._tell_ring(visitor, ring):
                visitor.ring = ring
        if now_ns < self._facts_due_ns:
            return
        self._sent_ns, self._facts_due_ns = now_ns, now_ns + FACTS_NS
        said = facts()
        for visitor in list(self._visitors.values()):
            if visitor.tell(said):
                visitor.took_ns = now_ns
            elif now_ns > visitor.took_ns + PATIENCE_NS:
                self._drop(visitor)

    def _uids(self) -> frozenset[int]:
        return viewer_uids()

    def _welcome(self, connection: socket.socket, peer: Peer) -> Onlooker:
        return Onlooker(connection, peer, self._clock.now_ns())

    def _greet(self, visitor: Onlooker) -> None:
        visitor.tell(Hello(version=__version__))
        visitor.tell(RingGone())  # until ``step`` passes it one
        self.hurry()

    def _attend(self, visitor: Onlooker) -> None:
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
    def _tell_ring(visitor: Onlooker, ring: RingReader | None) -> bool:
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


def viewer_uids() -> frozenset[int]:
    """Return who may look on: root, ourselves, and the screen's own user where there is one."""
    return uids_with(SCREEN_USER)
