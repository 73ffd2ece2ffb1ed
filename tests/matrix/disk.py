"""A file system that a test may fill, without harm to anybody else's."""

from __future__ import annotations

import contextlib
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

DISK_MB = 768


@contextlib.contextmanager
def small_disk() -> Iterator[Path]:
    """Yield a folder on a file system of its own, in a file (needs root)."""
    with tempfile.TemporaryDirectory(prefix="aff", dir="/tmp") as name:
        image, folder = Path(name) / "disk", Path(name) / "d"
        folder.mkdir()
        with image.open("wb") as stream:
            stream.truncate(DISK_MB << 20)
        subprocess.run(["mkfs.ext4", "-q", "-m", "0", str(image)], check=True)
        subprocess.run(["mount", "-o", "loop", str(image), str(folder)], check=True)
        try:
            yield folder
        finally:
            subprocess.run(["umount", "-l", str(folder)], check=True)
