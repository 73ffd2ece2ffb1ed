"""Who is at the other end of a unix socket: the kernel's word, and the login behind it.

A user id alone does not name a person: ``sudo`` makes everybody root or the service's user. The
login id is set once, when a person logs in, and stays through ``sudo`` and ``su``; variables such
as SUDO_USER are whatever the caller writes into them and are not looked at.
"""

from __future__ import annotations

import errno
import functools
import os
import pwd
import select
import socket
import struct
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from aff_runtime.base.printable import printable

SERVICE_USER = "aff-runtime"
NOBODY_LOGGED_IN = 2**32 - 1
_CREDENTIALS = struct.Struct("3i")
_DESCRIPTOR = struct.Struct("i")
_SO_PEERPIDFD = 77  # of Linux on x86-64 and ARM; Python's socket module does not name it
_PROC = Path("/proc")


@dataclass(frozen=True, slots=True, kw_only=True)
class Peer:
    """One process.

    Attributes
    ----------
    uid, pid : as the kernel gives them.
    login_uid : who logged in; ``NOBODY_LOGGED_IN`` for daemons, None where it cannot be read.
    """

    uid: int
    pid: int
    login_uid: int | None = None

    def __str__(self) -> str:
        """Return ``uid 1000 (tech1 via root), pid 4711``."""
        if self.login_uid is None:
            who = f"uid {self.uid} ({user_name(self.uid)}, login not known)"
        elif self.login_uid == NOBODY_LOGGED_IN:
            who = f"uid {self.uid} ({user_name(self.uid)}, no login)"
        elif self.login_uid != self.uid:
            who = f"uid {self.login_uid} ({user_name(self.login_uid)} via {user_name(self.uid)})"
        else:
            who = f"uid {self.uid} ({user_name(self.uid)})"
        return f"{who}, pid {self.pid}"


def peer_of(connection: socket.socket, proc: Path = _PROC) -> Peer:
    """Return who connected to us, or who listens where we have connected."""
    raw = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    pid, uid, _ = _CREDENTIALS.unpack(raw)
    login_uid = _login_uid(pid, uid, proc)
    # still alive after /proc was read: the pid cannot have been another process's there
    return Peer(uid=uid, pid=pid, login_uid=login_uid if _still_lives(connection) else None)


def own_process(proc: Path = _PROC) -> Peer:
    """Return ourselves."""
    uid, pid = os.geteuid(), os.getpid()
    return Peer(uid=uid, pid=pid, login_uid=_login_uid(pid, uid, proc))


def _still_lives(connection: socket.socket) -> bool:
    """Return whether the process that connected is there; True where the kernel cannot tell.

    The pid of one that has ended may be another's by now. Kernels from 6.5 on pass a descriptor
    of the process itself.
    """
    try:
        raw = connection.getsockopt(socket.SOL_SOCKET, _SO_PEERPIDFD, _DESCRIPTOR.size)
    except OSError as error:
        return error.errno == errno.ENOPROTOOPT
    (process,) = _DESCRIPTOR.unpack(raw)
    try:
        look = select.poll()
        look.register(process, select.POLLIN)
        return not look.poll(0)
    finally:
        os.close(process)


def _login_uid(pid: int, uid: int, proc: Path) -> int | None:
    """Return the login of a process; None: it has ended, is hidden, or is another user's."""
    folder = proc / str(pid)
    try:
        login = int((folder / "loginuid").read_text(encoding="ascii"))
        owner = folder.stat().st_uid
    except (OSError, ValueError):
        return None
    return login if owner in (uid, 0) else None


@functools.lru_cache(maxsize=64)
def user_name(uid: int) -> str:
    """Return a user's name, or a word that there is none."""
    try:
        return printable(pwd.getpwuid(uid).pw_name, 64)
    except (KeyError, OverflowError, OSError):
        return "no name"


def service_uids() -> frozenset[int]:
    """Return the users whose service we talk to: root, ourselves, and the service's own user."""
    return uids_with(SERVICE_USER)


def uids_with(name: str) -> frozenset[int]:
    """Return root, ourselves, and the user of this name where there is one."""
    try:
        installed = {pwd.getpwnam(name).pw_uid}
    except KeyError:
        installed = set()
    return frozenset({0, os.geteuid(), *installed})


def author_of(path: Path) -> str:
    """Return what a file system knows of who wrote a file: its owner, and when."""
    try:
        found = path.stat()
    except OSError as error:
        return f"who wrote it is not known: {error.strerror}"
    when = datetime.fromtimestamp(found.st_mtime, UTC).isoformat(timespec="seconds")
    return f"file of uid {found.st_uid} ({user_name(found.st_uid)}), written {when}"
