"""Counts of commands by action, way and result, since the service began."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from enum import StrEnum


class Via(StrEnum):
    """The way that a command came by."""

    CLI = "cli"
    HMI = "hmi"
    SIGNAL = "signal"


class Result(StrEnum):
    """What became of a command; late: not valid any more, repeated: its id was used before."""

    DONE = "done"
    REFUSED = "refused"
    LATE = "late"
    REPEATED = "repeated"


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandCount:
    """How often; ``action``, ``via`` and ``result`` are of closed sets."""

    action: str
    via: str
    result: str
    count: int


class CommandTally:
    """Counts commands."""

    def __init__(self) -> None:
        self._counts: Counter[tuple[str, str, str]] = Counter()

    def add(self, action: str, via: Via, result: Result) -> None:
        """Count one."""
        self._counts[action, via.value, result.value] += 1

    def rows(self) -> tuple[CommandCount, ...]:
        """Return what was counted, in the order of its names."""
        return tuple(
            CommandCount(action=action, via=via, result=result, count=count)
            for (action, via, result), count in sorted(self._counts.items())
        )
