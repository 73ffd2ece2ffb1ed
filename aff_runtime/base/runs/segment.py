"""One segment of a run as rows: whole ones are taken, and what is wrong with it is said."""

from __future__ import annotations

import gzip
import io
import math
import os
import re
import zlib
from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from aff_runtime.base.errors import AffError
from aff_runtime.base.files import CLOSED_TEXT, is_closed
from aff_runtime.base.runs.files import open_plain

LARGEST_VALUES = 60_000_000
"""Numbers that are held at once: 2 hours of 40 columns at 5 ms."""
ALTERED = (
    "its checksum is not that of its rows: something in it is not what was recorded; left out, "
    "copy it anew from the gateway"
)
_SEGMENT = re.compile(r"signals-(\d{1,9})\.csv\.gz")
_CHUNK = 1 << 20
_OTHER_CONTENT = ("CRC check failed", "Incorrect length of data")


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSegments:
    """The segments of a run at one look: who reads many windows of it looks once.

    Attributes
    ----------
    numbers, paths : in order.
    starts_s : times of the first rows, None where there is none.
    """

    numbers: tuple[int, ...]
    paths: tuple[Path, ...]
    starts_s: tuple[float | None, ...]

    @classmethod
    def looked_up(cls, folder: Path, n_columns: int) -> RunSegments:
        """Return the segments of a folder; the first row of each is unpacked."""
        found = segments_of(folder)
        rows = (first_row(path, n_columns) for _, path in found)
        starts = tuple(row[0] if row else None for row in rows)
        return cls(
            numbers=tuple(number for number, _ in found),
            paths=tuple(path for _, path in found),
            starts_s=starts,
        )

    @classmethod
    def known(cls, folder: Path, starts_s: Mapping[int, float]) -> RunSegments:
        """Return those of which starts by number are known; what was begun later is not there."""
        last = max(starts_s, default=0)
        found = [(number, path) for number, path in segments_of(folder) if number <= last]
        return cls(
            numbers=tuple(number for number, _ in found),
            paths=tuple(path for _, path in found),
            starts_s=tuple(starts_s.get(number) for number, _ in found),
        )

    def within(self, from_s: float, to_s: float) -> Iterator[Path]:
        """Yield the segments that may hold rows of a window; each ends where the next begins."""
        ends, end = [], math.inf
        for start in reversed(self.starts_s):
            ends.append(end)
            end = end if start is None else start
        for path, start, end in zip(self.paths, self.starts_s, reversed(ends), strict=True):
            # files are not trusted: one of another start, copied in, or altered, begins before
            # this one, and where this one ends is then not known
            if start is None or (start < to_s and (end > from_s or end < start)):
                yield path

    def span(self, names: Sequence[str]) -> str:
        """Return a sentence: from when to when the run has rows, of columns ``names``."""
        known = zip(self.starts_s, self.paths, strict=True)
        begun = sorted((start, path) for start, path in known if start is not None)
        if not begun:
            return "no segment of the run holds a row"
        rows, _ = rows_of(begun[-1][1], names, [0])
        end = rows[-1, 0] if rows.size else begun[-1][0]
        return f"the run has rows from {begun[0][0]:.1f} s to {end:.1f} s"


def segments_of(folder: Path) -> list[tuple[int, Path]]:
    """Return the segments of a run that are there, each with its number."""
    return sorted((int(m[1]), p) for p in folder.iterdir() if (m := _SEGMENT.fullmatch(p.name)))


def first_row(path: Path, n_columns: int) -> list[float]:
    """Return a segment's first row, empty where there is none."""
    try:
        with open_plain(path) as packed, gzip.open(packed) as file:
            file.readline(_CHUNK)
            row = [float(cell) for cell in file.readline(_CHUNK).split(b",")]
        return row if len(row) == n_columns and math.isfinite(row[0]) else []
    except (EOFError, OSError, zlib.error, ValueError):
        return []


def rows_of(
    path: Path, names: Sequence[str], wanted: Sequence[int]
) -> tuple[NDArray[np.float64], list[str]]:
    """Return the whole rows of one segment (rows, wanted), and what is to be said about it.

    Parameters
    ----------
    names : columns as ``run.yaml`` has them. ``wanted`` : places of those to return.

    Raises
    ------
    AffError
        It holds more than ``LARGEST_VALUES`` numbers.
    """
    nothing = np.empty((0, len(wanted)))
    if is_closed(path):
        return nothing, [f"{path.name}: {CLOSED_TEXT}"]
    content, torn, altered = _unpacked(path)
    if altered:
        return nothing, [f"{path.name}: {ALTERED}"]
    head, _, body = content.partition(b"\n")
    if head and head.decode("utf-8", "replace").split(",") != list(names):
        return nothing, [f"{path.name}: has other columns than run.yaml; left out"]
    body = body[: body.rfind(b"\n") + 1]
    said = [f"{path.name}: ends torn, its last row is whole" if body else ""] if torn else []
    if not body:
        return nothing, [f"{path.name}: holds no whole row"]
    lines = body.count(b"\n")
    if lines * len(wanted) > LARGEST_VALUES:  # before a number takes 8 bytes where it took 2
        raise AffError(f"{path.name}: one segment holds too much to be read at once")
    try:
        if body.count(b",") != (len(names) - 1) * lines:
            raise ValueError("a row of another length")
        rows = _parsed(body, wanted)
    except ValueError:
        rows, bad = _good_rows(body, names, wanted)
        said.append(f"{path.name}: {bad} rows cannot be read; left out")
    return rows, said


def _parsed(body: bytes, wanted: Sequence[int]) -> NDArray[np.float64]:
    return np.loadtxt(
        io.BytesIO(body),
        delimiter=",",
        usecols=tuple(wanted),
        ndmin=2,
        comments=None,
        encoding="latin1",
    )


def _good_rows(
    body: bytes, names: Sequence[str], wanted: Sequence[int]
) -> tuple[NDArray[np.float64], int]:
    """Return the rows that can be read, one by one, and how many cannot."""
    found, bad = array("d"), 0
    for line in io.BytesIO(body):
        try:
            if line.count(b",") != len(names) - 1:
                raise ValueError("a row of another length")
            cells = line.split(b",")
            found.extend([float(cells[k]) for k in wanted])
        except ValueError:
            bad += 1
    return np.array(found, dtype=np.float64).reshape(-1, len(wanted)), bad


def _unpacked(path: Path) -> tuple[bytes, bool, bool]:
    """Return what can be unpacked of a segment, whether its end is missing, whether it is another.

    The last: it was unpacked to its end, and its checksum is that of other rows.
    """
    chunks: list[bytes] = []
    size = 0
    try:
        with open_plain(path) as packed, gzip.open(packed) as file:
            # looked at before: gzip reads zeros behind its end byte by byte
            if os.fstat(packed.fileno()).st_size > LARGEST_VALUES * 8:
                raise AffError(f"{path.name}: one segment is too large to be read at once")
            while chunk := file.read1(_CHUNK):
                chunks.append(chunk)
                size += len(chunk)
                if size > LARGEST_VALUES * 8:
                    raise AffError(f"{path.name}: one segment is too large to be read at once")
    except gzip.BadGzipFile as error:
        return b"".join(chunks), True, str(error).startswith(_OTHER_CONTENT)
    except (EOFError, OSError, zlib.error):
        return b"".join(chunks), True, False
    return b"".join(chunks), False, False
