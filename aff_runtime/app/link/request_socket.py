"""The local request socket: line-JSON in, line-JSON out, for the service's own user alone.

The directory is 0700 and the socket 0600; besides, the kernel tells who is calling
(SO_PEERCRED), and anybody but our user and root is sent away.
"""

from __future__ import annotations

import fcntl
import json
import os
import socket
from collections import deque
from collections.abc import Callable
from pathlib import Path

from aff_runtime.app.link.answers import Answer, refusal
from aff_runtime.app.link.peer import Peer, peer_of
from aff_runtime.app.link.requests import MAX_REQUEST_BYTES, Ident, Request, longest
from aff_runtime.app.link.runtime_directory import make_private
from aff_runtime.base.errors import AffError, RefusedError
from aff_runtime.base.printable import printable
from aff_runtime.base.socket_file import identity, make_room, remove_own

MAX_CALLERS = 16  # that wait for no answer; above that the longest silent one goes
BACKLOG = 64  # connections that the kernel keeps until they are accepted
_ANOTHER = "name another --runtime-dir"


class Caller:
    """One connected caller: its requests not yet done, and the answers that it has not taken yet.

    Attributes
    ----------
    peer : who it is, by the kernel.
    owed : requests of it that wait for their answer.
    """

    def __init__(self, connection: socket.socket, peer: Peer) -> None:
        connection.setblocking(False)
        self.connection = connection
        self.peer = peer
        self.owed = 0
        self._begun_line = b""
        self._lines: deque[bytes] = deque()
        self._unsent = b""

    @property
    def has_more(self) -> bool:
        """Whether whole requests of it wait to be done, or an answer to be sent to its end."""
        return bool(self._lines or self._unsent)

    @property
    def is_too_long(self) -> bool:
        """Whether the line that it has begun is already longer than a request may be."""
        return not self._lines and len(self._begun_line) > longest(self._begun_line)

    def read(self) -> bool:
        """Take what has come; False when the caller has closed."""
        try:
            chunk = self.connection.recv(MAX_REQUEST_BYTES)
        except BlockingIOError:
            return True
        except OSError:
            return False
        *lines, self._begun_line = (self._begun_line + chunk).split(b"\n")
        self._lines.extend(lines)
        return bool(chunk)

    def next_line(self) -> bytes | None:
        """Return the next complete line; None without one, or while an answer is on its way.

        So answers never pile up: a caller that takes no answer gets no further request done.
        """
        return self._lines.popleft() if self._lines and not self._unsent else None

    def send(self, answer: Answer, ident: Ident = None) -> None:
        """Send one answer; what the caller does not take now is sent when it does.

        ``ident`` : the caller's own number of its request, echoed.
        """
        said = answer.to_json()
        if ident is not None:
            said["id"] = ident
        self._unsent += json.dumps(said).encode() + b"\n"
        self.flush()

    def flush(self) -> bool:
        """Send what is left; False when the caller has closed."""
        try:
            while self._unsent:
                self._unsent = self._unsent[self.connection.send(self._unsent) :]
        except BlockingIOError:
            return True
        except OSError:
            self._unsent = b""
            return False
        return True


class Asked:
    """One request of one caller; it gets one answer, now or later.

    Parameters
    ----------
    caller : who asked.
    request : what.

    Attributes
    ----------
    then : called with the answer once it is given; None: nothing is.
    """

    __slots__ = ("_is_answered", "caller", "request", "then")

    def __init__(self, caller: Caller, request: Request) -> None:
        self.caller = caller
        self.request = request
        self._is_answered = False
        self.then: Callable[[Answer], None] | None = None
        caller.owed += 1

    @property
    def who(self) -> str:
        """Return who commands: the kernel's word, and on whose behalf as the caller claims."""
        claimed = printable(self.request.by).replace('"', "'")
        return (
            f'{self.caller.peer}, on behalf of "{claimed}" as it says'
            if claimed
            else (str(self.caller.peer))
        )

    def answer(self, answer: Answer) -> None:
        """Answer it, with the caller's own number of it; a second answer is dropped."""
        if self._is_answered:
            return
        self._is_answered = True
        self.caller.owed -= 1
        self.caller.send(answer, self.request.ident)
        if self.then is not None:
            self.then(answer)

    def refuse(self, error: AffError) -> None:
        """Say no, and why."""
        self.answer(refusal(error))


class RequestSocket:
    """Listens on the request socket.

    Raises
    ------
    RefusedError
        When another service already runs there, or no socket can be made there.
    """

    def __init__(self, path: Path) -> None:
        make_private(path.parent)
        lock = path.with_suffix(".lock")
        try:
            self._lock = os.open(
                lock, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o600
            )
        except OSError as error:
            raise _unusable(lock, error) from None
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(self._lock)
            raise RefusedError(
                f"{path}: a service already runs here; stop it with `aff-runtime stop`, "
                "or name another --runtime-dir"
            ) from None
        self._path = path
        self.listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        before = os.umask(0o177)
        try:
            make_room(path, _ANOTHER)
            self.listener.bind(str(path))
            self._made = identity(path)
        except (OSError, RefusedError) as error:
            self.listener.close()
            os.close(self._lock)
            raise (_unusable(path, error) if isinstance(error, OSError) else error) from None
        finally:
            os.umask(before)
        self.listener.listen(BACKLOG)
        self.listener.setblocking(False)
        self.callers: dict[int, Caller] = {}

    def accept(self) -> Caller | None:
        """Take one waiting caller; None when it is not allowed."""
        try:
            connection, _ = self.listener.accept()
        except OSError:
            return None
        peer = peer_of(connection)
        if not is_allowed_uid(peer.uid, os.geteuid()):
            connection.close()
            return None
        caller = Caller(connection, peer)
        self.callers[connection.fileno()] = caller
        return caller

    def heard(self, caller: Caller) -> None:
        """Note that ``caller`` has just sent a request: it is the last to be surplus."""
        self.callers[caller.connection.fileno()] = self.callers.pop(caller.connection.fileno())

    def surplus(self) -> Caller | None:
        """Return who has been silent longest when there are too many: none may shut out others.

        Who waits for an answer is not silent.
        """
        idle = [caller for caller in self.callers.values() if not caller.owed]
        return idle[0] if len(idle) > MAX_CALLERS else None

    @property
    def waiting(self) -> int:
        """How many callers wait for an answer."""
        return sum(caller.owed > 0 for caller in self.callers.values())

    def drop(self, caller: Caller) -> None:
        """Close the connection of ``caller``."""
        self.callers.pop(caller.connection.fileno(), None)
        caller.connection.close()

    def close(self) -> None:
        """Stop listening and remove the socket."""
        for caller in list(self.callers.values()):
            self.drop(caller)
        self.listener.close()
        remove_own(self._path, self._made)
        os.close(self._lock)


def _unusable(path: Path, error: OSError) -> RefusedError:
    """Return the refusal of a runtime directory in which nothing can be made."""
    reason = error.strerror or error
    return RefusedError(f"{path}: {reason}; remove it, or {_ANOTHER}")


def is_allowed_uid(uid: int, own_uid: int) -> bool:
    """Return whether user ``uid`` may command a service of user ``own_uid``."""
    return uid in (own_uid, 0)
