"""Notices that a file at a path is another one than before, whichever way it was replaced."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

Signature = tuple[tuple[int, int, int], ...]


class FileWatch:
    """Watches paths (not inodes) by modification time, size and inode.

    A change counts once the signature has been the same for two looks in a row, so a file that is
    still being written is left alone.
    """

    def __init__(self, paths: Iterable[Path]) -> None:
        self._paths = tuple(paths)
        self._accepted = self._signature()
        self._previous = self._accepted

    def watch(self, paths: Iterable[Path]) -> None:
        """Watch other paths from now on; what a new one holds now counts as known.

        A path that stays keeps its signature: it may have changed again since it was looked at.
        """
        accepted = dict(zip(self._paths, self._accepted, strict=True))
        self._paths = tuple(paths)
        self._previous = self._signature()
        self._accepted = tuple(
            accepted.get(path, found)
            for path, found in zip(self._paths, self._previous, strict=True)
        )

    def changed(self) -> bool:
        """Return True once per settled change."""
        present = self._signature()
        settled = present == self._previous
        self._previous = present
        if settled and present != self._accepted:
            self._accepted = present
            return True
        return False

    def _signature(self) -> Signature:
        """Return modification time, size and inode per path; zeros for a missing one."""
        return tuple(_one(path) for path in self._paths)


def _one(path: Path) -> tuple[int, int, int]:
    """Return the signature of one path."""
    try:
        found = path.stat()
    except OSError:
        return (0, 0, 0)
    return (found.st_mtime_ns, found.st_size, found.st_ino)
