"""Who has come to ``hand.sock``: packets in, packets out, and nothing is buffered."""

from __future__ import annotations

import selectors
import socket
from collections.abc import Callable
from pathlib import Path

from aff_runtime.app.hand.messages import MAX_PACKET_BYTES, Told, encode
from aff_runtime.app.link.peer import Peer, uids_with
from aff_runtime.app.supervisor.packet_listener import SCREEN_USER, PacketSocket, Visitor

MAX_VISITORS = 4
PACKETS_PER_ROUND = 16  # of one visitor, before others have their turn
ANOTHER = "name another folder with --hand-dir"


class ScreenVisitor(Visitor):
    """One screen."""

    def tell(self, message: Told) -> None:
        """Send one packet; who does not take it misses it."""
        try:
            self.connection.send(encode(message))
        except OSError:
            return


class Visits(PacketSocket[ScreenVisitor]):
    """Listens at ``hand.sock`` in a folder.

    Parameters
    ----------
    welcome : called with who has come; its exceptions are not caught.
    hear : called with every packet; False sends the visitor away.
    """

    KIND = ScreenVisitor
    MOST = MAX_VISITORS

    def __init__(
        self,
        folder: Path,
        selector: selectors.BaseSelector,
        welcome: Callable[[ScreenVisitor], None],
        hear: Callable[[ScreenVisitor, bytes], bool],
        *,
        is_private: bool,
    ) -> None:
        self._say_welcome = welcome
        self._hear = hear
        super().__init__(folder / "hand.sock", selector, ANOTHER, is_private=is_private)

    def _uids(self) -> frozenset[int]:
        return screen_uids()

    def _welcome(self, connection: socket.socket, peer: Peer) -> ScreenVisitor:
        return ScreenVisitor(connection, peer)

    def _greet(self, visitor: ScreenVisitor) -> None:
        self._say_welcome(visitor)

    def _attend(self, visitor: ScreenVisitor) -> None:
        """Take up to ``PACKETS_PER_ROUND`` packets of one visitor."""
        for _ in range(PACKETS_PER_ROUND):
            try:
                packet = visitor.connection.recv(MAX_PACKET_BYTES + 1)
            except BlockingIOError:
                return
            except OSError:
                packet = b""
            if not packet or not self._hear(visitor, packet):
                self._drop(visitor)
                return


def screen_uids() -> frozenset[int]:
    """Return who may come: root, ourselves, and the screen's own user where there is one."""
    return uids_with(SCREEN_USER)
