"""Keeps the recordings below a size by deleting the oldest segments of the oldest runs.

Only what this service wrote goes: files of a run, in a folder that is named like a run, holds
``run.yaml`` and is no link. Nothing is followed out of the folder of runs.
"""

from __future__ import annotations

import contextlib
import os
import re
import stat
from pathlib import Path

from aff_runtime.base.runs.responses import RESPONSE_FILE

MARK = "run.yaml"
_RUN_NAME = re.compile(r"\d{8}T\d{6}Z_")
_SEGMENT = re.compile(r"signals-.*\.csv\.gz")
_SITE = r"site-[0-9a-f]+\.yaml|(site(-[0-9a-f]+)?\.yaml|summary\.json)\.part"
_SMALL = re.compile(rf"{_SITE}|{RESPONSE_FILE.pattern}(\.part)?")
_LATER = re.compile(rf"{_SEGMENT.pattern}|{_SMALL.pattern}")
_OTHERS = ("site.yaml", "events.csv", "summary.json", MARK)  # the mark last: a rest is still a run
_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC


def used_bytes(directory: Path) -> int:
    """Return the size of all run folders in ``directory``, bytes."""
    return sum(_folder_bytes(folder) for folder in _run_folders(directory))


def free_bytes(directory: Path) -> tuple[int, int] | None:
    """Return what a service may still write where ``directory`` is, and the size of that disk.

    Both in bytes; None when it is not known.
    """
    try:
        disk = os.statvfs(directory)
    except OSError:
        return None
    return disk.f_bavail * disk.f_frsize, disk.f_blocks * disk.f_frsize


def delete_oldest(directory: Path, *, max_bytes: int, keep: Path) -> int:
    """Delete oldest segments until the runs fit; return how many went.

    Parameters
    ----------
    directory : folder of run folders; anything else in it is left alone.
    max_bytes : bound on the sum of all run folders, bytes.
    keep : segment being written; never deleted, nor its folder. Its run is thinned out last,
        even where a clock that was set back names it as the oldest.
    """
    folders = sorted(_run_folders(directory), key=lambda folder: folder == keep.parent)
    excess = sum(_folder_bytes(folder) for folder in folders) - max_bytes
    deleted = 0
    for folder in folders:
        if excess <= 0:
            break
        with contextlib.suppress(OSError):
            at = os.open(folder, _FOLDER)
            try:
                freed, count = _thin_out(at, excess, "" if folder != keep.parent else keep.name)
            finally:
                os.close(at)
            excess -= freed
            deleted += count
            if excess > 0 and folder != keep.parent:
                folder.rmdir()
    return deleted


def _thin_out(at: int, excess: int, keep: str) -> tuple[int, int]:
    """Delete segments of one run until ``excess`` bytes are freed, and then the run's other files.

    Parameters
    ----------
    at : descriptor of the run's folder: what is deleted lies in it and nowhere else.
    keep : name of the segment being written, of a run that is to stay; empty: all may go.

    Return the bytes freed and the number of segments.
    """
    freed = count = 0
    segments = [name for name in os.listdir(at) if _SEGMENT.fullmatch(name)]
    for name in sorted(segments, key=lambda name: (len(name), name)):  # 9999 before 10000
        if freed >= excess:
            return freed, count
        if name != keep and (size := _delete(at, name)) is not None:
            freed += size
            count += 1
    if freed < excess and not keep:
        small = [name for name in os.listdir(at) if _SMALL.fullmatch(name)]
        freed += sum(_delete(at, name) or 0 for name in (*small, *_OTHERS))
    return freed, count


def _delete(at: int, name: str) -> int | None:
    """Delete one file of the folder ``at``, a link itself; return its bytes, None if it stays."""
    try:
        size = os.stat(name, dir_fd=at, follow_symlinks=False).st_size
        os.unlink(name, dir_fd=at)
    except OSError:
        return None
    return size


def _run_folders(directory: Path) -> list[Path]:
    """Return the run folders, oldest first (their names begin with the UTC stamp)."""
    try:
        names = sorted(name for name in os.listdir(directory) if _RUN_NAME.match(name))
    except OSError:
        return []
    return [directory / name for name in names if _is_run(directory / name)]


def _is_run(folder: Path) -> bool:
    """Return whether this is a run's folder, and no link to one."""
    try:
        return stat.S_ISDIR(folder.lstat().st_mode) and stat.S_ISREG(
            (folder / MARK).lstat().st_mode
        )
    except OSError:
        return False


def _folder_bytes(folder: Path) -> int:
    """Return the size of one run's own files, bytes; others never go, so they do not count."""
    total = 0
    with contextlib.suppress(OSError):
        for path in folder.iterdir():
            with contextlib.suppress(OSError):
                if path.name in _OTHERS or _LATER.fullmatch(path.name):
                    total += path.lstat().st_size
    return total
