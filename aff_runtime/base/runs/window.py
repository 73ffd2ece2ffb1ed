"""A part of a run as people name it: ``RUN_DIR``, ``RUN_DIR@120..300``, ``RUN_DIR@2:00..``."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from aff_runtime.base.errors import AffError
from aff_runtime.base.files import is_closed
from aff_runtime.base.printable import printable

MARK = "run.yaml"
HOW_WRITTEN = "times of a run are written RUN_DIR@FROM..TO, such as RUN_DIR@2:00..12:00"
MOST_OF_A_CLOCK = 60
RIGHT_TO_S = 1.0
"""A person who writes the times of a window reads them off to a second."""
_TIME = re.compile(r"(?:(?:(?P<h>\d{1,9}):)?(?P<m>\d{1,9}):)?(?P<s>\d{1,9}(?:\.\d*)?)")


@dataclass(frozen=True, slots=True, kw_only=True)
class RunWindow:
    """A run folder and the times in it that are meant, s of its column ``time_s``.

    That clock begins with the control process: a folder that was begun later, since the columns
    changed, does not begin at 0.

    Attributes
    ----------
    folder : of the run.
    from_s, to_s : rows with from_s <= time_s < to_s; 0 and infinity where nothing was said.
    """

    folder: Path
    from_s: float = 0.0
    to_s: float = math.inf

    def __str__(self) -> str:
        """Return it as it would be written."""
        if self.from_s == 0.0 and math.isinf(self.to_s):
            return printable(str(self.folder))
        end = "" if math.isinf(self.to_s) else f"{self.to_s:.13g}"
        return f"{printable(str(self.folder))}@{self.from_s:.13g}..{end}"


def names_a_run(path: str | Path) -> bool:
    """Return whether this is a run folder, or a part of one; True of one that is closed to us."""
    folder, _, times = str(path).rpartition("@")
    if _is_folder(path):
        return _has_mark(Path(path))
    return ".." in times and _is_folder(folder) and _has_mark(Path(folder))


def run_window(text: str | Path) -> RunWindow:
    """Return what ``RUN_DIR[@FROM..TO]`` means; times in s, ``m:s`` or ``h:m:s``, either left out.

    Raises
    ------
    AffError
        The times cannot be read, or there is nothing between them.
    """
    whole = str(text)
    folder, at, times = whole.rpartition("@")
    if _is_folder(whole) or not at or ".." not in times:
        return RunWindow(folder=Path(whole))
    first, _, last = times.partition("..")
    window = RunWindow(
        folder=Path(folder),
        from_s=_seconds(whole, first, 0.0),
        to_s=_seconds(whole, last, math.inf),
    )
    if not window.from_s < window.to_s:
        raise AffError(
            f"{printable(whole)}: nothing lies between {window.from_s:g} s and {window.to_s:g} s; "
            "give the earlier time first"
        )
    return window


def not_recorded(window: RunWindow, first_s: float, last_s: float) -> Iterator[str]:
    """Yield a sentence for each end of a window where a record has no rows, by its outer ones."""
    if window.from_s > 0.0 and first_s - window.from_s > RIGHT_TO_S:
        yield f"nothing is recorded from {window.from_s:g} s, where it begins, to {first_s:.1f} s"
    if math.isfinite(window.to_s) and window.to_s - last_s > RIGHT_TO_S:
        yield f"nothing is recorded from {last_s:.1f} s to {window.to_s:g} s, where it ends"


def _has_mark(folder: Path) -> bool:
    """Return whether a folder is a run's; who may not look is told so by what reads it."""
    return is_closed(folder / MARK) or (folder / MARK).exists()


def _is_folder(path: str | Path) -> bool:
    """Return whether a folder is there; False too for a name that no folder can have."""
    try:
        return Path(path).is_dir()
    except OSError:
        return False


def _seconds(whole: str, text: str, absent: float) -> float:
    if not text:
        return absent
    match = _TIME.fullmatch(text)
    if match is None:
        raise AffError(
            f"{printable(whole)}: read {printable(text, 20)!r} for a time; write seconds of "
            "its time_s (120), minutes (2:00) or hours (1:02:00), such as RUN_DIR@2:00..12:00"
        )
    hours, minutes, seconds = match["h"], match["m"], float(match["s"])
    if (minutes and seconds >= MOST_OF_A_CLOCK) or (hours and int(minutes) >= MOST_OF_A_CLOCK):
        raise AffError(
            f"{printable(whole)}: read {printable(text, 20)!r} for a time; behind a colon a "
            "number is below 60"
        )
    return 3600.0 * int(hours or 0) + 60.0 * int(minutes or 0) + seconds
