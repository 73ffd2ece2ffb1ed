"""What a person or the line did, as flags over the curves of trends."""

from __future__ import annotations

import sqlite3
from dataclasses import dataclass

from aff_hmi.notices import filled
from aff_hmi.see.events import Kind, between
from aff_hmi.words import Say

FLAGGED = ("PROBE", "ROLL", "SPLICE", "SHAPE", "CONTROL")
"""Events that explain a step in a curve, beside all that is of settings."""
MOST_FLAGS = 200


@dataclass(frozen=True, slots=True, kw_only=True)
class Flag:
    """One event at its wall time, s; ``text`` is in the reader's language."""

    utc_s: float
    name: str
    text: str


def flags(connection: sqlite3.Connection, from_s: float, to_s: float, say: Say) -> list[Flag]:
    """Return the newest flags from one wall time to another, s, the oldest of them first."""
    found = between(connection, from_s, to_s, kind=Kind.SETTINGS, names=FLAGGED, most=MOST_FLAGS)
    return [
        Flag(utc_s=round(one.utc_s, 1), name=one.name, text=filled(one.text, one.values, say))
        for one in found
    ]
