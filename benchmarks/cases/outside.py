"""What counts as right of something that no library holds: its class, and its coordinate."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

Numbers = Mapping[str, Any]
CLOSE = 0.02
"""Share by which a period or a frequency may be off."""
LINE_Hz = 0.02
"""The same of one line of many: what some 60 s resolve."""
WORDS_LINES, BURST_BAND = 3, 0.3
"""Up to which multiple of their rate words that stand still may be told by; how far from its
frequency, as a share, the lines of a vibration that comes in bursts may lie."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """One hidden kind.

    Attributes
    ----------
    what : in words. mark : a number of the label that no other kind has.
    unknown_class, coordinate : the class that is right, and what of it has to be.
    reason : why it is that class.
    is_right : whether a coordinate of that class is right, by the label's numbers.
    """

    what: str
    mark: str
    unknown_class: str
    coordinate: str
    reason: str
    is_right: Callable[[Numbers, Numbers], bool]


def _near(value: float, true: float) -> bool:
    return abs(value / true - 1.0) < CLOSE


def _words(hidden: Numbers, where: Numbers) -> bool:
    if "period_s" in where:
        return _near(where["period_s"], hidden["every_s"])
    multiple = where.get("frequency_Hz", 0.0) * hidden["every_s"]
    return 1 <= round(multiple) <= WORDS_LINES and _near(multiple, round(multiple))


def _play(hidden: Numbers, where: Numbers) -> bool:
    return "tension" in str(where.get("channel", ""))


def _bursts(hidden: Numbers, where: Numbers) -> bool:
    """Return whether a line is one of the bursts'.

    Bursts that start alike have lines at multiples of their rate; of a vibration that goes on
    between them the lines are multiples of the rate away from its own frequency.
    """
    every_s, own_Hz = float(hidden["every_s"]), float(hidden["frequency_Hz"])
    if "period_s" in where and _near(where["period_s"], every_s):
        return True
    line_Hz = float(where.get("frequency_Hz", 0.0))
    off = [abs(x * every_s - round(x * every_s)) / every_s for x in (line_Hz, line_Hz - own_Hz)]
    return abs(line_Hz / own_Hz - 1.0) < BURST_BAND and min(off) < LINE_Hz


def _pulsation(hidden: Numbers, where: Numbers) -> bool:
    period = {"frequency_Hz": 1.0 / where["period_s"]} if "period_s" in where else {}
    return _near({**period, **where}.get("frequency_Hz", 0.0), hidden["frequency_Hz"])


KINDS = (
    Kind(
        what="correction words stand still periodically",
        mark="hold_s",
        unknown_class="time",
        coordinate="period of the stops, or a line at once to three times their rate",
        reason="a clock stops them, whatever speed and radius are",
        is_right=_words,
    ),
    Kind(
        what="sticking load-cell mounts (play)",
        mark="band_N",
        unknown_class="state",
        coordinate="the channel of a load cell",
        reason="the reading depends on which way the force went last, at no time of its own",
        is_right=_play,
    ),
    Kind(
        what="support vibration bursts",
        mark="velocity_m_s",
        unknown_class="time",
        coordinate="period of the bursts, or a line of theirs near the vibration's frequency",
        reason="a clock starts each burst",
        is_right=_bursts,
    ),
    Kind(
        what="air-bar pulsation",
        mark="strain",
        unknown_class="time",
        coordinate="its frequency",
        reason="a fan's, at every speed of the line",
        is_right=_pulsation,
    ),
)


def table() -> list[str]:
    """Return what is right as lines of a Markdown table."""
    rows = [(k.what, k.unknown_class, k.coordinate, k.reason) for k in KINDS]
    head = [("outside the library", "class", "coordinate", "for"), ("---",) * 4]
    return [f"| {' | '.join(row)} |" for row in (*head, *rows)]


def is_honest(hidden: Numbers, verdict: Mapping[str, Any]) -> bool:
    """Return whether a verdict names no effect, and the class and the coordinate of ``hidden``.

    Everything that it says to be unknown has to be of that class, or not told from it, and at
    least one at the right coordinate.
    """
    kind = next(kind for kind in KINDS if kind.mark in hidden)
    answers = [
        [row["coordinate"] for row in rows if row["class"] == kind.unknown_class]
        for rows in ((u, *u.get("alternatives", ())) for u in verdict.get("unknown", ()))
    ]
    said = [where for row in answers for where in row]
    right = all(answers) and any(kind.is_right(hidden, where) for where in said)
    return bool(right and not verdict.get("effects"))
