"""What stands and asks for a person, before it is put into anybody's language."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from aff_runtime.app.report.alarm_table import Priority

LASTS_S = 60.0
TIMING, ROLLS = "/timing", "/rolls"
RANK = {Priority.HIGH: 1, Priority.MEDIUM: 2, Priority.LOW: 3}


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """Something that stands and asks for a person; words are English, still to be translated.

    Attributes
    ----------
    key : the same as long as it stands. ``rank`` : 1 is the most urgent.
    values : put into ``text`` where it says ``{name}``; words of others come by them.
    delay_s : for how long it stands before it is an alarm: what comes and goes is none.
    code : of the event that it is; 0 where it is none of the event table.
    page : where this screen shows more of it, path and place; empty for nowhere.
    """

    key: str
    rank: int
    name: str
    text: str
    to_do: str
    values: Mapping[str, str] = field(default_factory=dict)
    delay_s: float = 0.0
    code: int = 0
    page: str = ""
