"""Files that other processes read while they are replaced."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
from pathlib import Path

NEW_FILE_MODE = 0o666  # less what the process's umask takes
CLOSED_TEXT = "you may not look there; with `sudo` before the command you may"


def is_closed(path: Path) -> bool:
    """Return whether we may not look at a path, so that nothing is known of what is there."""
    try:
        path.stat()
    except PermissionError:
        return True
    except (OSError, ValueError):
        return False
    return not os.access(path, os.R_OK)


def replace_text(path: Path, text: str, *, keep_owner: bool = False) -> None:
    """Write ``text`` as UTF-8, as ``replace_bytes`` does."""
    replace_bytes(path, text.encode("utf-8"), keep_owner=keep_owner)


def replace_bytes(path: Path, content: bytes, *, keep_owner: bool = False) -> None:
    """Write ``content`` to ``path`` so that a reader sees the old file or the whole new one.

    The new file is made under a name that nobody can know before, and never through a link: in a
    folder that others may write to, what lies there already is not followed and not written. The
    mode of the file that is replaced is kept, and with ``keep_owner`` its owner as far as we may.
    A link in its place is replaced itself.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_name(f".{path.name}.{secrets.token_hex(8)}.new")
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
    descriptor = os.open(fresh, flags, NEW_FILE_MODE)
    try:
        with open(descriptor, "wb") as file:
            if (found := _present(path)) is not None:
                if keep_owner:
                    with contextlib.suppress(OSError):
                        os.fchown(descriptor, found.st_uid, found.st_gid)
                os.fchmod(descriptor, found.st_mode & 0o777)
            file.write(content)
            file.flush()
            os.fsync(descriptor)
        fresh.replace(path)
    except OSError:
        with contextlib.suppress(OSError):
            fresh.unlink(missing_ok=True)
        raise
    _write_back(path.parent)


def _present(path: Path) -> os.stat_result | None:
    """Return what the file that is replaced is like, None where there is no file."""
    try:
        found = path.lstat()
    except FileNotFoundError:
        return None
    return found if stat.S_ISREG(found.st_mode) else None


def _write_back(folder: Path) -> None:
    """Have the new name on the disk too, as far as the file system can."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
