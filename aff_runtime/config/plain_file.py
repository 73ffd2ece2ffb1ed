"""Reading a file that a site names: one that ends, and not a pipe or a device in its place."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

MAX_BYTES = 1 << 20  # the DBC file of one bus has 100 kB, the EDS file of a large drive 600 kB


class TooLargeError(ValueError):
    """The file is longer than what is asked for may be."""


def read_plain(path: Path, max_bytes: int = MAX_BYTES) -> bytes:
    """Return what a file holds; never more than ``max_bytes`` are read.

    Raises
    ------
    OSError
        It cannot be read, or is a folder.
    TooLargeError
        It is larger than ``max_bytes``.
    ValueError
        It is a pipe, a device or a socket.
    """
    _check_kind(path.stat().st_mode, path)  # before opening: that alone can set off a device
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK | os.O_NOCTTY)
    try:
        _check_kind(os.fstat(descriptor).st_mode, path)  # it may have been replaced meanwhile
        with open(descriptor, "rb", closefd=False) as file:
            content = file.read(max_bytes + 1)
    finally:
        os.close(descriptor)
    if len(content) > max_bytes:
        shown = f"{max_bytes >> 20} MB" if max_bytes >= 1 << 20 else f"{max_bytes >> 10} kB"
        raise TooLargeError(f"is larger than {shown}")
    return content


def _check_kind(mode: int, path: Path) -> None:
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(mode):
        raise ValueError("is not a file")
