"""What a caller may ask about settings: to compare, try, keep, undo them, or to see what was."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

from aff_runtime.base.errors import RefusedError

ACTS = ("state", "diff", "try", "keep", "save", "undo", "history")
KEYS = ("act", "text", "seconds", "why", "version", "base", "tried")
START = b'{"do": "settings"'
"""How a line begins that may hold a whole site file."""
MAX_BYTES = 1 << 19
LEAST_S, MOST_S = 5.0, 3600.0  # of a try
LEAST_WHY, MOST_WHY = 8, 400  # characters of a reason


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingsRequest:
    """One request about settings.

    Attributes
    ----------
    act : one of ``ACTS``.
    text : of a whole site file, for ``diff``, ``try`` and ``save``.
    seconds : of a try, until the former settings return.
    why : the caller's reason, for ``try``, ``keep``, ``save`` and ``undo``.
    version : of the history, for ``undo`` and ``history``; 0: the one before, or all.
    base : sha256 of the text that ``try``, ``save`` or ``undo`` was decided on: of what runs, or
        for ``save`` of what is saved and waits for bypass; empty: any.
    tried : sha256 of the tried text that ``keep`` or ``undo`` is about, and of nothing else;
        empty: of whatever is tried, and ``undo`` without a try is of what was kept last.
    """

    act: str
    text: str = ""
    seconds: float = 0.0
    why: str = ""
    version: int = 0
    base: str = ""
    tried: str = ""


def settings_request(said: Any) -> SettingsRequest:
    """Return what the keys of a request ask.

    Raises
    ------
    RefusedError
        When one of them is unknown, missing or out of its range.
    """
    act = said.get("act")
    if act not in ACTS:
        raise RefusedError(f"act: one of {', '.join(ACTS)} is needed")
    needs_text = act in ("diff", "try", "save")
    needs_why = act in ("try", "keep", "save", "undo")
    return SettingsRequest(
        act=act,
        text=_text(said.get("text")) if needs_text else "",
        seconds=_seconds(said.get("seconds")) if act == "try" else 0.0,
        why=reason_of(said.get("why")) if needs_why else "",
        version=_version(said.get("version", 0)),
        base=_sha256("base", said.get("base", "")),
        tried=_sha256("tried", said.get("tried", "")),
    )


def _text(given: object) -> str:
    if not isinstance(given, str) or not given:
        raise RefusedError("text: the text of a whole site file is needed")
    return given


def _seconds(given: object) -> float:
    right = isinstance(given, int | float) and not isinstance(given, bool)
    if not right or not math.isfinite(given) or not LEAST_S <= given <= MOST_S:  # type: ignore[arg-type,operator]
        raise RefusedError(f"seconds: {LEAST_S:g} to {MOST_S:g} are needed")
    return float(given)  # type: ignore[arg-type]


def reason_of(given: object) -> str:
    """Return a reason without the blanks around it.

    Raises
    ------
    RefusedError
        It is none, or has fewer than ``LEAST_WHY`` or more than ``MOST_WHY`` characters.
    """
    if not isinstance(given, str) or not LEAST_WHY <= len(given.strip()) <= MOST_WHY:
        said = f"{len(given.strip())} characters" if isinstance(given, str) else "no text"
        raise RefusedError(
            f"why: read {said}, a reason of {LEAST_WHY} to {MOST_WHY} characters is needed"
        )
    return given.strip()


def _sha256(key: str, given: object) -> str:
    if not isinstance(given, str) or re.fullmatch("([0-9a-f]{64})?", given) is None:
        raise RefusedError(f"{key}: the sha256 of a site file is needed")
    return given


def _version(given: object) -> int:
    if not isinstance(given, int) or isinstance(given, bool) or not 0 <= given < 1 << 31:
        raise RefusedError("version: a number of the history is needed")
    return given
