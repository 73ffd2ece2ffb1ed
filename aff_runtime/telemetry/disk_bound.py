"""Keeps the recordings below a size by deleting the oldest segments of the oldest runs."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path

_RUN_NAME = re.compile(r"\d{8}T\d{6}Z_")


def used_bytes(directory: Path) -> int:
    """Return the size of all run folders in ``directory``, bytes."""
    return sum(_folder_bytes(folder) for folder in _run_folders(directory))


def delete_oldest(directory: Path, *, max_bytes: int, keep: Path) -> int:
    """Delete oldest segments until the runs fit; return how many went.

    Parameters
    ----------
    directory : folder of run folders; anything not named like a run is left alone.
    max_bytes : bound on the sum of all run folders, bytes.
    keep : segment being written; never deleted, nor its folder.
    """
    excess = used_bytes(directory) - max_bytes
    deleted = 0
    for folder in _run_folders(directory):
        for segment in sorted(folder.glob("signals-*.csv.gz")):
            if excess <= 0:
                return deleted
            if segment == keep:
                continue
            size = segment.stat().st_size
            with contextlib.suppress(OSError):
                segment.unlink()
                excess -= size
                deleted += 1
        if excess > 0 and folder != keep.parent:
            excess -= _delete_folder(folder)
    return deleted


def _run_folders(directory: Path) -> list[Path]:
    """Return the run folders, oldest first (their names begin with the UTC stamp)."""
    if not directory.is_dir():
        return []
    return sorted(p for p in directory.iterdir() if _RUN_NAME.match(p.name) and p.is_dir())


def _folder_bytes(folder: Path) -> int:
    """Return the size of the files of one run folder, bytes."""
    total = 0
    for path in folder.iterdir():
        with contextlib.suppress(OSError):
            total += path.stat().st_size
    return total


def _delete_folder(folder: Path) -> int:
    """Delete what is left of a run whose segments are gone; return the bytes freed."""
    freed = _folder_bytes(folder)
    with contextlib.suppress(OSError):
        for name in ("run.yaml", "site.yaml", "events.csv", "summary.json"):
            (folder / name).unlink(missing_ok=True)
        folder.rmdir()
    return freed
