"""A folder for compiled code that nobody else can write: what lies in it is run."""

from __future__ import annotations

import logging
import os
import stat
from pathlib import Path

_OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


def own_cache_folder(*levels: str) -> Path | None:
    """Return the folder ``levels`` below the user's cache folder, made where it is missing.

    The user's is ``XDG_CACHE_HOME``, else ``~/.cache``. numba unpickles what it finds, so a
    folder that is another user's, that others may write, or that is a link is not taken, and no
    other in its place: None then, which a line in the log says.
    """
    try:
        place = _users_folder()
        for level in levels:
            place = place / level
            place.mkdir(mode=0o700, exist_ok=True)
            _refuse(place, place.lstat())
    except (OSError, RuntimeError, ValueError) as error:
        logging.getLogger(__name__).warning(
            "compiled code is not kept, every start compiles anew: %s", error
        )
        return None
    return place


def _users_folder() -> Path:
    """Return the user's cache folder; in it, nobody else may move what is ours."""
    named = Path(os.environ.get("XDG_CACHE_HOME") or "")
    place = named if named.is_absolute() else Path.home() / ".cache"
    place.mkdir(mode=0o700, parents=True, exist_ok=True)
    found = place.stat()
    sticky = bool(found.st_mode & stat.S_ISVTX)
    if found.st_uid not in (0, os.getuid()) or (found.st_mode & _OTHERS_WRITE and not sticky):
        raise ValueError(
            f"{place} can be written by others; take it back (chown, chmod go-w) or set "
            "XDG_CACHE_HOME to a folder of your own"
        )
    return place


def _refuse(place: Path, found: os.stat_result) -> None:
    """Raise ValueError, with what to do, for a folder that is not this user's alone to write."""
    if not stat.S_ISDIR(found.st_mode):
        raise ValueError(f"{place} is a link or a file; take it away")
    if found.st_uid != os.getuid():
        raise ValueError(f"{place} belongs to user {found.st_uid}; take it away")
    if found.st_mode & _OTHERS_WRITE:
        raise ValueError(f"{place} can be written by others; take it away, then it is made anew")
