"""A socket of packets in a folder that nobody else may write in, for door and hand."""

from __future__ import annotations

import contextlib
import os
import socket
import stat
from pathlib import Path

from aff_runtime.app.link.runtime_directory import WRITTEN_BY_OTHERS
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.socket_file import make_room


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
    """Refuse a folder in which somebody else could put a door of his own."""
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid not in (0, os.geteuid()):
        raise RefusedError(f"{folder}: is no folder of user {os.geteuid()} or root; {another}")
    if found.st_mode & WRITTEN_BY_OTHERS:
        mode = stat.S_IMODE(found.st_mode)
        raise RefusedError(f"{folder}: its mode {mode:04o} lets others write in it; {another}")


def _check_free(path: Path, another: str) -> None:
    """Refuse a door at which another service stands."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as probe:
        probe.setblocking(False)
        with contextlib.suppress(OSError):
            probe.connect(str(path))
            raise RefusedError(f"{path}: another service stands at this door; {another}")
