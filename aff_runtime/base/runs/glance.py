"""What a run's folder says at a glance: two lines of ``run.yaml`` and two rows."""

from __future__ import annotations

import gzip
import re
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from aff_runtime.base.numbers import finite_or_none
from aff_runtime.base.printable import printable
from aff_runtime.base.runs.files import open_plain, text_of, yaml_values
from aff_runtime.base.runs.segment import segments_of
from aff_runtime.base.runs.window import MARK

LONGEST = 200  # characters of a value
_LARGEST_YAML, _LONGEST_ROW = 1 << 20, 1 << 20  # bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class Glance:
    """A run whose rows were not read; what cannot be read is empty.

    Attributes
    ----------
    line : its name. ``start_utc`` : when the run began, as written.
    from_s, last_s : times of the first rows of the first and the last segment.
    segments : how many there are.
    """

    line: str
    start_utc: str
    from_s: float | None
    last_s: float | None
    segments: int


def glance(folder: Path) -> Glance:
    """Return what a run's folder says at a glance.

    Raises
    ------
    OSError
        It cannot be listed.
    """
    text = text_of(folder / MARK, _LARGEST_YAML)
    segments = segments_of(folder)
    ends = [_first_time_s(path) for _, path in (segments[:1] + segments[-1:])]
    return Glance(
        line=_value_of("name", text),
        start_utc=_value_of("start_utc", text),
        from_s=ends[0] if ends else None,
        last_s=ends[-1] if ends else None,
        segments=len(segments),
    )


def _value_of(key: str, text: str) -> str:
    """Return a value that stands on one line; the whole file would take long to parse."""
    found = re.search(rf"^{key}: [^\n]{{1,{LONGEST}}}$", text, re.MULTILINE)
    try:
        said = yaml_values(found[0]) if found else None
    except ValueError:
        said = None
    return printable(str(said[key]), LONGEST) if isinstance(said, Mapping) else ""


def _first_time_s(path: Path) -> float | None:
    try:
        with open_plain(path) as packed, gzip.open(packed) as file:
            file.readline(_LONGEST_ROW)
            time_s = float(file.readline(_LONGEST_ROW).split(b",")[0])
    except (EOFError, OSError, zlib.error, ValueError):
        return None
    return finite_or_none(time_s)
