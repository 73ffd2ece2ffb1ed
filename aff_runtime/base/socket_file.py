"""The file of a socket: one that is left over is taken away, and nothing else ever is."""

from __future__ import annotations

import contextlib
import errno
import socket
import stat
from pathlib import Path

from aff_runtime.base.errors import RefusedError


def make_room(path: Path, another: str) -> None:
    """Take away a socket that was left at ``path``.

    Parameters
    ----------
    another : how to name another place, for the refusal.

    Raises
    ------
    RefusedError
        When something else is there: it stays.
    OSError
        When it cannot be looked at or taken away.
    """
    try:
        kind = path.lstat().st_mode
    except FileNotFoundError:
        return
    if not stat.S_ISSOCK(kind):
        raise RefusedError(f"{path}: is no socket and stays; take it away, or {another}")
    path.unlink(missing_ok=True)


def listens(path: Path, kind: socket.SocketKind) -> bool:
    """Return whether somebody answers at ``path``; a file that was left behind does not."""
    with socket.socket(socket.AF_UNIX, kind) as caller:
        caller.setblocking(False)
        try:
            caller.connect(str(path))
        except BlockingIOError:  # its queue is full
            return True
        except OSError as error:
            return error.errno == errno.EPROTOTYPE  # it lives, and speaks another way
    return True


def identity(path: Path) -> tuple[int, int]:
    """Return what tells this file from another one of its name."""
    found = path.lstat()
    return found.st_dev, found.st_ino


def remove_own(path: Path, made: tuple[int, int]) -> None:
    """Take away the socket that we made; what has come into its place since is not ours."""
    with contextlib.suppress(OSError):
        if identity(path) == made:
            path.unlink()
