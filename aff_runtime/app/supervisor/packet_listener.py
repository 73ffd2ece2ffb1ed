"""A socket of packets in a folder that nobody else may write in, for door and hand."""

from __future__ import annotations

import errno
import os
import selectors
import socket
import stat
from abc import ABC, abstractmethod
from pathlib import Path
from typing import ClassVar, Generic, TypeVar

from aff_runtime.app.link.peer import Peer, peer_of
from aff_runtime.app.link.runtime_directory import WRITTEN_BY_OTHERS
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.socket_file import identity, make_room, remove_own

SCREEN_USER = "aff-hmi"
"""The user that a screen runs as."""
FREE = (errno.ENOENT, errno.ECONNREFUSED)
"""What connecting says of a path where nobody listens: no file, or a service that is gone."""


class Visitor:
    """One who has come; ``peer`` is who it is, by the kernel."""

    def __init__(self, connection: socket.socket, peer: Peer) -> None:
        connection.setblocking(False)
        self.connection = connection
        self.peer = peer


V = TypeVar("V", bound=Visitor)


class PacketSocket(ABC, Generic[V]):
    """A listening socket and its visitors: let in, attended to, sent away when too many.

    Parameters
    ----------
    is_private : the socket is for our own user alone.
    another : how to name another place, for the refusals.

    Raises
    ------
    RefusedError
        When no socket can be made there, others may write there, or another service uses it.
    """

    KIND: ClassVar[type[Visitor]]
    MOST: ClassVar[int]
    """Visitors at a time, and connections that wait to be accepted."""

    def __init__(
        self, path: Path, selector: selectors.BaseSelector, another: str, *, is_private: bool
    ) -> None:
        self._path = path
        self._selector = selector
        self._visitors: dict[int, V] = {}
        self._listener = listening(path, 0o600 if is_private else 0o660, self.MOST, another)
        self._made = identity(path)
        selector.register(self._listener, selectors.EVENT_READ)

    def serve(self, key: selectors.SelectorKey) -> bool:
        """Do what a selector's event asks for; False when it is none of ours."""
        if key.fileobj is self._listener:
            self._let_in()
        elif isinstance(key.data, self.KIND):
            known = self._visitors.get(key.fd)
            if known is not None and known is key.data:
                self._attend(known)
        else:
            return False
        return True

    def close(self) -> None:
        """Send everybody away and remove the socket."""
        for visitor in list(self._visitors.values()):
            self._drop(visitor)
        self._listener.close()
        remove_own(self._path, self._made)

    @abstractmethod
    def _uids(self) -> frozenset[int]:
        """Return who may come."""

    @abstractmethod
    def _welcome(self, connection: socket.socket, peer: Peer) -> V:
        """Return who has come by this connection."""

    @abstractmethod
    def _greet(self, visitor: V) -> None:
        """Send the first packets to a new visitor."""

    @abstractmethod
    def _attend(self, visitor: V) -> None:
        """Take what one visitor has sent."""

    def _let_in(self) -> None:
        """Take one visitor; when there are too many, the one who came first goes."""
        try:
            connection, _ = self._listener.accept()
        except OSError:
            return
        peer = peer_of(connection)
        if peer.uid not in self._uids():
            connection.close()
            return
        visitor = self._welcome(connection, peer)
        self._visitors[connection.fileno()] = visitor
        self._selector.register(connection, selectors.EVENT_READ, visitor)
        self._greet(visitor)
        if len(self._visitors) > self.MOST:
            self._drop(next(iter(self._visitors.values())))

    def _drop(self, visitor: V) -> None:
        self._visitors.pop(visitor.connection.fileno(), None)
        self._selector.unregister(visitor.connection)
        visitor.connection.close()


def listening(path: Path, mode: int, backlog: int, another: str) -> socket.socket:
    """Return a listening socket of ``mode`` at ``path``.

    Parameters
    ----------
    another : how to name another place, for the refusals.

    Raises
    ------
    RefusedError
        When no socket can be made there, others may write there, or another service uses it.
    """
    try:
        _check_folder(path.parent, another)
        _check_free(path, another)
        make_room(path, another)
        listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET | socket.SOCK_NONBLOCK)
        before = os.umask(0o777 & ~mode)
        try:
            listener.bind(str(path))
            listener.listen(backlog)
        except BaseException:
            listener.close()
            raise
        finally:
            os.umask(before)
    except OSError as error:
        raise RefusedError(f"{path}: {error.strerror or error}; {another}") from None
    return listener


def _check_folder(folder: Path, another: str) -> None:
    """Refuse a folder in which somebody else could put a socket of his own."""
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid not in (0, os.geteuid()):
        raise RefusedError(f"{folder}: is no folder of user {os.geteuid()} or root; {another}")
    if found.st_mode & WRITTEN_BY_OTHERS:
        mode = stat.S_IMODE(found.st_mode)
        raise RefusedError(f"{folder}: its mode {mode:04o} lets others write in it; {another}")


def _check_free(path: Path, another: str) -> None:
    """Refuse a path at which another service listens."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as caller:
        caller.setblocking(False)
        try:
            caller.connect(str(path))
        except OSError as error:
            if error.errno in FREE:
                return
    raise RefusedError(f"{path}: another service listens at this socket; {another}")
