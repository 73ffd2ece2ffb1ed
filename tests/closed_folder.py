"""A folder of somebody else's: what a command says that may not look into it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

NOBODY = 65534


@contextmanager
def closed(folder: Path) -> Iterator[Path]:
    """Close a folder to this process; root becomes another user meanwhile.

    What the test asks for has to be imported before: root's libraries are closed then too.
    """
    mode = folder.stat().st_mode & 0o777
    folder.chmod(0)
    is_root = os.geteuid() == 0
    if is_root:
        os.seteuid(NOBODY)
    try:
        yield folder
    finally:
        if is_root:
            os.seteuid(0)
        folder.chmod(mode)
