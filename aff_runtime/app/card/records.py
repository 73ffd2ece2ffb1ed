"""Which files of a record a window lies in, and their hashes: what can be repeated later."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from aff_runtime.app.card.entries import RecordWindow, Segment
from aff_runtime.base.errors import AffError
from aff_runtime.base.printable import printable
from aff_runtime.base.runs.files import open_plain
from aff_runtime.base.runs.table import FirstRow, first_rows
from aff_runtime.base.runs.window import RunWindow

MOST_SEGMENTS = 1_000
_CHUNK = 1 << 20


def segment_name(number: int) -> str:
    """Return the file name of a segment."""
    return f"signals-{number:04d}.csv.gz"


def record_window(window: RunWindow, from_s: float, to_s: float) -> RecordWindow:
    """Return a window with the hashes of its segments as they are now.

    A segment that is still written only grows: its size is kept with its hash.

    Raises
    ------
    AffError
        The folder is no run, or a segment cannot be read.
    """
    _, rows = first_rows(window.folder)
    names = [segment_name(number) for number in _within(rows, from_s, to_s)]
    if len(names) > MOST_SEGMENTS:
        raise AffError(f"{window}: lies in more than {MOST_SEGMENTS} files; give a shorter window")
    folder = window.folder.absolute()
    return RecordWindow(
        folder=str(folder),
        from_s=from_s,
        to_s=to_s,
        segments=tuple(_segment(folder / name) for name in names),
    )


def differences(window: RecordWindow) -> Iterator[str]:
    """Yield what is not any more as it was when a window was measured."""
    for segment in window.segments:
        if os.path.basename(segment.name) != segment.name:
            yield f"{printable(segment.name, 60)}: is no name of a segment"
            continue
        path = Path(window.folder) / segment.name
        try:
            size, digest = _digest(path, segment.size)
        except OSError as error:
            yield f"{path}: {error.strerror}"
            continue
        if size < segment.size:
            yield f"{path}: has {size} bytes, had {segment.size}"
        elif digest != segment.sha256:
            yield f"{path}: its first {segment.size} bytes are not what they were"


def _within(rows: Sequence[FirstRow], from_s: float, to_s: float) -> Iterator[int]:
    """Yield the numbers of segments that hold rows of a window."""
    starts = [row.values["time_s"] for row in rows]
    for row, start, end in zip(rows, starts, [*starts[1:], float("inf")], strict=True):
        # files are not trusted: one of another start, copied in, or altered, begins before this
        # one, and where this one ends is then not known
        if start <= to_s and (end > from_s or end < start):
            yield row.number


def _segment(path: Path) -> Segment:
    try:
        size, digest = _digest(path, os.stat(path).st_size)
    except OSError as error:
        raise AffError(f"{path}: {error.strerror}; the window cannot be put on the card") from None
    return Segment(name=path.name, size=size, sha256=digest)


def _digest(path: Path, size: int) -> tuple[int, str]:
    """Return how many bytes were there of ``size``, and their SHA-256."""
    digest = hashlib.sha256()
    left = size
    with open_plain(path) as file:
        while left and (chunk := file.read(min(left, _CHUNK))):
            digest.update(chunk)
            left -= len(chunk)
    return size - left, digest.hexdigest()
