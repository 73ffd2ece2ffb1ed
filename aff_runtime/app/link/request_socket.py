"""The local request socket: line-JSON in, line-JSON out, for the service's own user alone.

The directory is 0700 and the socket 0600; besides, the kernel tells who is calling
(SO_PEERCRED), and anybody but our user and root is sent away.
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
import socket
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from aff_runtime.app.link.runtime_directory import make_private
from aff_runtime.base.errors import RefusedError

MAX_REQUEST_BYTES = 4096
MAX_CALLERS = 16
_CREDENTIALS = struct.Struct("3i")


class Caller:
    """One connected caller and what it has said so far."""

    def __init__(self, connection: socket.socket) -> None:
        connection.setblocking(False)
        self.connection = connection
        self._heard = b""

    def requests(self) -> list[dict[str, Any]] | None:
        """Return the complete requests that came; None when the caller is gone or babbles."""
        try:
            chunk = self.connection.recv(MAX_REQUEST_BYTES)
        except BlockingIOError:
            return []
        except OSError:
            return None
        *lines, self._heard = (self._heard + chunk).split(b"\n")
        if not chunk or len(self._heard) > MAX_REQUEST_BYTES:
            return None
        requests: list[dict[str, Any]] = []
        for line in lines:
            try:
                request = json.loads(line)
            except (ValueError, RecursionError):
                return None
            if not isinstance(request, dict):
                return None
            requests.append(request)
        return requests

    def reply(self, answer: Mapping[str, Any]) -> None:
        """Send one answer; a caller that does not listen loses it."""
        with contextlib.suppress(OSError):
            self.connection.sendall(json.dumps(answer).encode() + b"\n")


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
            self._lock = os.open(lock, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
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
            path.unlink(missing_ok=True)
            self.listener.bind(str(path))
        except OSError as error:
            self.listener.close()
            os.close(self._lock)
            raise _unusable(path, error) from None
        finally:
            os.umask(before)
        self.listener.listen(64)
        self.listener.setblocking(False)
        self.callers: dict[int, Caller] = {}

    def accept(self) -> Caller | None:
        """Take one waiting caller; None when it is not allowed."""
        try:
            connection, _ = self.listener.accept()
        except OSError:
            return None
        if not _is_allowed(connection):
            connection.close()
            return None
        caller = Caller(connection)
        self.callers[connection.fileno()] = caller
        return caller

    def heard(self, caller: Caller) -> None:
        """Note that ``caller`` has just spoken."""
        self.callers[caller.connection.fileno()] = self.callers.pop(caller.connection.fileno())

    def surplus(self) -> Caller | None:
        """Return who has been silent longest when there are too many: none may shut out others."""
        return next(iter(self.callers.values())) if len(self.callers) > MAX_CALLERS else None

    def drop(self, caller: Caller) -> None:
        """Close the connection of ``caller``."""
        self.callers.pop(caller.connection.fileno(), None)
        caller.connection.close()

    def close(self) -> None:
        """Stop listening and remove the socket."""
        for caller in list(self.callers.values()):
            self.drop(caller)
        self.listener.close()
        self._path.unlink(missing_ok=True)
        os.close(self._lock)


def _unusable(path: Path, error: OSError) -> RefusedError:
    """Return the refusal of a runtime directory in which nothing can be made."""
    reason = error.strerror or error
    return RefusedError(f"{path}: {reason}; remove it, or name another --runtime-dir")


def _is_allowed(connection: socket.socket) -> bool:
    """Return whether the calling process belongs to our user or to root."""
    raw = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    _, uid, _ = _CREDENTIALS.unpack(raw)
    return is_allowed_uid(uid, os.geteuid())


def is_allowed_uid(uid: int, own_uid: int) -> bool:
    """Return whether user ``uid`` may command a service of user ``own_uid``."""
    return uid in (own_uid, 0)
