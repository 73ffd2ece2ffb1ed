"""What `aff-runtime watch` found last: a small text in its store, read without the tables."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.files import replace_text
from aff_runtime.base.printable import printable
from aff_runtime.config.site_paths import STATE_DIRECTORY

STORE = STATE_DIRECTORY / "watch"
"""Where the timer that `install.sh --records` brings keeps what it knows of the line."""
FILE = "notes.json"
MOST, LONGEST = 50, 400
"""Notes, and characters of one, that are read of a file."""
_LARGEST = 1 << 20

Limits = Mapping[tuple[str, str], float]


@dataclass(frozen=True, slots=True, kw_only=True)
class WatchNotes:
    """What to know first of a line.

    Attributes
    ----------
    line : its name. ``looked_utc`` : when runs were last taken, or an exchange told, with zone.
    notes : sentences; empty where nothing stands out.
    limits : (roller, SI unit, size): the sizes of ripple that were given as a roller's limit.
    """

    line: str
    looked_utc: str
    notes: tuple[str, ...]
    limits: tuple[tuple[str, str, float], ...] = ()

    @property
    def looked_s(self) -> float:
        """When that was, s since 1970."""
        return datetime.fromisoformat(self.looked_utc).timestamp()

    def by_roller(self) -> dict[tuple[str, str], float]:
        """Return the limits by roller and unit."""
        return {(roller, unit): size for roller, unit, size in self.limits}


def write_notes(store: Path, notes: WatchNotes) -> None:
    """Put the notes into their store.

    Raises
    ------
    ConfigError
        They cannot be written.
    """
    try:
        replace_text(store / FILE, json.dumps(asdict(notes), indent=1) + "\n")
    except OSError as error:
        raise ConfigError(f"{store / FILE}: cannot be written ({error.strerror})") from None


def read_notes(store: Path) -> WatchNotes | None:
    """Return the notes of a store; None where there are none that can be read."""
    from aff_runtime.base.runs.files import text_of  # noqa: PLC0415 - yaml, half of a status

    try:
        said: Any = json.loads(text_of(store / FILE, _LARGEST))
        found = WatchNotes(
            line=printable(str(said["line"]), LONGEST),
            looked_utc=printable(str(said["looked_utc"]), LONGEST),
            notes=tuple(printable(str(text), LONGEST) for text in list(said["notes"])[:MOST]),
            limits=tuple((str(r), str(u), float(size)) for r, u, size in said["limits"]),
        )
        return found if found.looked_s > 0.0 else None
    except (KeyError, TypeError, ValueError, OverflowError, RecursionError):
        return None


def notes_of(store: Path, line: str) -> WatchNotes | None:
    """Return the notes of a store where they are of this line."""
    found = read_notes(store)
    return found if found is not None and found.line == line else None
