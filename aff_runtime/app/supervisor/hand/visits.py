"""Who has come to ``hand.sock``: packets in, packets out, and nothing is buffered."""

from __future__ import annotations

import selectors
import socket
from collections.abc import Callable
from pathlib import Path

from aff_runtime.app.hand.messages import MAX_PACKET_BYTES, Told, encode
from aff_runtime.app.link.peer import Peer, peer_of, uids_with
from aff_runtime.app.supervisor.packet_listener import listening
from aff_runtime.base.socket_file import identity, remove_own

SCREEN = "aff-hmi"
MAX_VISITORS = 4
PACKETS_PER_ROUND = 16
ANOTHER = "name another folder with --hand-dir"


class Visitor:
    """One screen; ``peer`` is who it is, by the kernel."""

    def __init__(self, connection: socket.socket, peer: Peer) -> None:
        connection.setblocking(False)
        self.connection = connection
        self.peer = peer

    def tell(self, message: Told) -> None:
        """Send one packet; who does not take it misses it."""
        try:
            self.connection.send(encode(message))
        except OSError:
            return


class Visits:
    """Listens at ``hand.sock`` in a folder.

    Parameters
    ----------
    is_private : the socket is for our own user alone.
    welcome : called with who has come; what it raises nobody catches.
    hear : called with every packet; False sends the visitor away.

    Raises
    ------
    RefusedError
        When no socket can be made there, others may write there, or another service uses it.
    """

    def __init__(
        self,
        folder: Path,
        selector: selectors.BaseSelector,
        welcome: Callable[[Visitor], None],
        hear: Callable[[Visitor, bytes], bool],
        *,
        is_private: bool,
    ) -> None:
        self._path = folder / "hand.sock"
        self._selector = selector
        self._welcome = welcome
        self._hear = hear
        self._visitors: dict[int, Visitor] = {}
        mode = 0o600 if is_private else 0o660
        self._listener = listening(self._path, mode, MAX_VISITORS, ANOTHER)
        self._made = identity(self._path)
        selector.register(self._listener, selectors.EVENT_READ)

    def serve(self, key: selectors.SelectorKey) -> bool:
        """Do what a selector's event asks for; False when it is none of ours."""
        if key.fileobj is self._listener:
            self._let_in()
        elif isinstance(key.data, Visitor):
            if self._visitors.get(key.fd) is key.data:
                self._attend(key.data)
        else:
            return False
        return True

    def close(self) -> None:
        """Send everybody away and remove the socket."""
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
        peer = peer_of(connection)
        if peer.uid not in screen_uids():
            connection.close()
            return
        visitor = Visitor(connection, peer)
        self._visitors[connection.fileno()] = visitor
        self._selector.register(connection, selectors.EVENT_READ, visitor)
        self._welcome(visitor)
        if len(self._visitors) > MAX_VISITORS:
            self._drop(next(iter(self._visitors.values())))

    def _attend(self, visitor: Visitor) -> None:
        """Hear one visitor for a while; others want their turn."""
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

    def _drop(self, visitor: Visitor) -> None:
        self._visitors.pop(visitor.connection.fileno(), None)
        self._selector.unregister(visitor.connection)
        visitor.connection.close()


def screen_uids() -> frozenset[int]:
    """Return who may come: root, ourselves, and the screen's own user where there is one."""
    return uids_with(SCREEN)
