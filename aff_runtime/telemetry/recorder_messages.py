"""What supervisor and recorder say to each other: one JSON object a line, here and nowhere else.

The first line to the recorder is the context of the run, every later one a note; the recorder
reports about itself.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any


@dataclass(frozen=True, slots=True, kw_only=True)
class RunContext:
    """What the supervisor knows of a run.

    Attributes
    ----------
    name : of the line. ``started_by`` : who started the service.
    learned : digests of learned files by actuator and kind.
    max_MB : all records together. ``segment_s`` : length of one segment.
    wire_files : digests of the files that describe the wire, by name.
    site_text : the site file as it was checked.
    takes_over : run folder of a recorder of the same ring that died; empty without one.
    died : how that one ended, in words.
    """

    name: str = "line"
    site_file: str = ""
    started_by: str = ""
    site_hash: str = ""
    learned: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    max_MB: float = 500.0
    segment_s: float = 60.0
    wire_files: Mapping[str, str] = field(default_factory=dict)
    site_text: str = ""
    takes_over: str = ""
    died: str = ""

    def encode(self) -> bytes:
        """Return the context as one line."""
        return json.dumps(asdict(self)).encode() + b"\n"

    @classmethod
    def from_json(cls, said: Any) -> RunContext:
        """Read plain values; what is not said is as by default, what is unknown is left out."""
        return cls(**_known(cls, said))


@dataclass(frozen=True, slots=True, kw_only=True)
class Note:
    """A sentence of the supervisor for ``events.csv``; without a name it is none.

    ``site_text``, ``site_hash`` : of the site file that runs from then on; empty where none does.
    ``response``, ``actuator`` : text of a response that was measured, and of what; empty without.
    """

    name: str = "NOTE"
    text: str = ""
    site_text: str = ""
    site_hash: str = ""
    response: str = ""
    actuator: str = ""

    def encode(self) -> bytes:
        """Return the note as one line."""
        return json.dumps(asdict(self)).encode() + b"\n"


NOT_SAID = -1


@dataclass(frozen=True, slots=True, kw_only=True)
class RecorderReport:
    """How recording goes; rows count from where its recorder began.

    Attributes
    ----------
    kept_bytes : of all runs, as last added up; `NOT_SAID` until a segment has ended.
    max_bytes, free_bytes, disk_bytes : what all runs may take; what the disk has left; its size.
        `NOT_SAID` of a recorder that cannot say.
    """

    folder: str = ""
    rows: int = 0
    rows_lost: int = 0
    ring_overruns: int = 0
    error: str = ""
    alive: bool = False
    kept_bytes: int = NOT_SAID
    max_bytes: int = NOT_SAID
    free_bytes: int = NOT_SAID
    disk_bytes: int = NOT_SAID

    @property
    def lost(self) -> int:
        """Rows that are in no file."""
        return self.rows_lost + self.ring_overruns

    def encode(self) -> bytes:
        """Return the report as one line; whether the recorder lives, others must see."""
        said = asdict(self)
        del said["alive"]
        return json.dumps(said).encode() + b"\n"

    @classmethod
    def from_json(cls, said: Any) -> RecorderReport:
        """Read plain values; what is unknown is left out."""
        return cls(**_known(cls, said))

    def seen(self, *, alive: bool) -> RecorderReport:
        """Return the report with whether its recorder lives."""
        return replace(self, alive=alive)


def context_of(line: bytes) -> RunContext | None:
    """Return the context of one line; None when it is none."""
    said = _object_in(line)
    return None if said is None else RunContext.from_json(said)


def note_of(line: bytes) -> Note | None:
    """Return the note of one line; None when it is none."""
    said = _object_in(line)
    if said is None:
        return None
    return Note(
        name=str(said.get("name", "NOTE")),
        text=str(said.get("text", "")),
        site_text=str(said.get("site_text", "")),
        site_hash=str(said.get("site_hash", "")),
        response=str(said.get("response", "")),
        actuator=str(said.get("actuator", "")),
    )


def report_of(line: bytes) -> RecorderReport | None:
    """Return the report of one line; None when it is none."""
    said = _object_in(line)
    return None if said is None else RecorderReport.from_json(said)


def _known(record: type[RunContext | RecorderReport], said: Any) -> Any:
    """Return those of plain values that a record has fields for."""
    names = {one.name for one in fields(record)}
    return {name: value for name, value in said.items() if name in names}


def _object_in(line: bytes) -> Any:
    """Return the JSON object of a line, None when it holds none."""
    try:
        said = json.loads(line)
    except ValueError:
        return None
    return said if isinstance(said, dict) else None
