"""Reading a file that a site names: one that ends, and not a pipe or a device in its place."""

from __future__ import annotations

import stat
from pathlib import Path

MAX_BYTES = 16 << 20  # the DBC files of whole vehicles have some MB


def read_plain(path: Path) -> bytes:
    """Return what a file holds.

    Raises
    ------
    OSError
        It cannot be read.
    ValueError
        It is a pipe, a device or a socket, or larger than ``MAX_BYTES``.
    """
    found = path.stat()
    if stat.S_IFMT(found.st_mode) not in (stat.S_IFREG, stat.S_IFDIR):
        raise ValueError("is not a file")
    if found.st_size > MAX_BYTES:
        raise ValueError(f"is larger than {MAX_BYTES >> 20} MB")
    return path.read_bytes()
