"""Writes rows as gzip CSV segments of bounded length; a full disk costs rows, nothing else.

A segment that the disk refused whole is written again in its own place: a disk that is full for
hours leaves one empty file, and not one for every batch.
"""

from __future__ import annotations

import contextlib
import gzip
import io
import zlib
from collections.abc import Sequence
from pathlib import Path


class SegmentWriter:
    """Appends rows to ``signals-0001.csv.gz``, ``signals-0002.csv.gz``, ...

    Parameters
    ----------
    folder : run folder.
    columns : names with units; the first one is ``time_s``.
    segment_s : length of one segment in the time of the rows, s.
    after : number of the newest segment of the folder that another recorder wrote.

    Attributes
    ----------
    rows_written, rows_lost : number of rows; lost are those that the disk refused.
    last_error : text of the last refusal, empty when none.
    """

    def __init__(
        self, folder: Path, columns: Sequence[str], *, segment_s: float, after: int = 0
    ) -> None:
        self._folder = folder
        self._header = ",".join(columns) + "\n"
        self._row = ",".join(map(_format_of, columns)) + "\n"
        self._segment_s = segment_s
        self._file: io.BufferedWriter | None = None
        self._gzip: gzip.GzipFile | None = None
        self._index = after
        self._holds_rows = True  # of the segment ``_index``; so the first one gets number 1
        self._end_s = 0.0
        self.rows_written = 0
        self.rows_lost = 0
        self.last_error = ""

    @property
    def path(self) -> Path:
        """Path of the newest segment."""
        return self._folder / f"signals-{self._index:04d}.csv.gz"

    def append(self, rows: Sequence[Sequence[float]]) -> bool:
        """Write ``rows`` and flush them; return True when a new segment was begun."""
        begun = False
        start = 0
        while start < len(rows):
            if self._gzip is None or rows[start][0] >= self._end_s:
                begun = True
                self._begin(rows[start][0])
            stop = start
            while stop < len(rows) and rows[stop][0] < self._end_s:
                stop += 1
            stop = max(stop, start + 1)
            self._put([self._row % tuple(row) for row in rows[start:stop]])
            start = stop
        return begun

    def close(self) -> None:
        """End the present segment."""
        if self._gzip is not None and self._file is not None:
            try:
                self._gzip.close()
                self._file.close()
            except OSError as error:
                self.last_error = str(error)
            self._abandon()

    def _begin(self, time_s: float) -> None:
        """Open the next segment, whose rows lie before ``time_s + segment_s``."""
        self.close()
        if self._holds_rows:
            self._index += 1
        self._holds_rows = False
        self._end_s = time_s + self._segment_s
        try:
            self._file = self.path.open("wb")
            self._gzip = gzip.GzipFile(fileobj=self._file, mode="wb", compresslevel=3, mtime=0)
            self._gzip.write(self._header.encode())
        except OSError as error:
            self.last_error = str(error)
            self._abandon()

    def _put(self, lines: list[str]) -> None:
        """Write one batch and make it readable; count it as lost when that fails."""
        if self._gzip is None or self._file is None:
            self.rows_lost += len(lines)
            return
        try:
            self._gzip.write("".join(lines).encode())
            self._gzip.flush(zlib.Z_SYNC_FLUSH)
            self._file.flush()
        except OSError as error:
            self.last_error = str(error)
            self.rows_lost += len(lines)
            self._abandon()
        else:
            self._holds_rows = True
            self.rows_written += len(lines)

    def _abandon(self) -> None:
        """Forget the open files; the next batch begins a new segment."""
        for file in (self._gzip, self._file):
            if file is not None:
                with contextlib.suppress(OSError, ValueError):
                    file.close()
        self._gzip = None
        self._file = None


def _format_of(column: str) -> str:
    """Return how a column is written; time and counted angles grow for as long as a process runs.

    Ten digits part ticks of 10 ms after 115 days, and hundredths of a radian after a month.
    """
    grows = column == "time_s" or (column.endswith("_rad") and "." not in column)
    return "%.13g" if grows else "%.10g"
