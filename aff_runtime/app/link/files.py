"""Files that other processes read while they are replaced."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
from pathlib import Path

NEW_FILE_MODE = 0o666  # less what the process's umask takes


def replace_text(path: Path, text: str) -> None:
    """Write ``text`` to ``path`` so that a reader sees the old file or the whole new one.

    The new file is made under a name that nobody can know before, and never through a link: in a
    folder that others may write to, what lies there already is not followed and not written. The
    mode of the file that is replaced is kept; a link in its place is replaced itself.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_name(f".{path.name}.{secrets.token_hex(8)}.new")
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
    descriptor = os.open(fresh, flags, NEW_FILE_MODE)
    try:
        with open(descriptor, "w", encoding="utf-8") as file:
            if (mode := _mode_of(path)) is not None:
                os.fchmod(descriptor, mode)
            file.write(text)
            file.flush()
            os.fsync(descriptor)
        fresh.replace(path)
    except OSError:
        with contextlib.suppress(OSError):
            fresh.unlink(missing_ok=True)
        raise
    _write_back(path.parent)


def _mode_of(path: Path) -> int | None:
    """Return the mode of the file that is replaced, None where there is no file."""
    try:
        found = path.lstat().st_mode
    except FileNotFoundError:
        return None
    return found & 0o777 if stat.S_ISREG(found) else None


def _write_back(folder: Path) -> None:
    """Have the new name on the disk too, as far as the file system can."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
