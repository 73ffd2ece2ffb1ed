"""Real-time rights in the reader's language: granted or not, and what it costs to go without."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from aff_hmi.words import N_, Say
from aff_runtime.base.printable import printable
from aff_runtime.telemetry.header import Right

LONGEST = 160
# how a right's text begins: its name, and what it costs when it is refused
KNOWN = {
    "memory locked": (
        N_("its memory stays in the machine's"),
        N_("a page that was put out holds up a tick by milliseconds"),
    ),
    "on processor": (
        N_("a processor of its own"),
        N_("it moves between processors, and other work sits where it runs"),
    ),
    "/dev/cpu_dma_latency": (
        N_("processors do not sleep deeply"),
        N_("it wakes up to some 0.1 ms later"),
    ),
    "timer slack": (N_("exact timer"), N_("it wakes up to 0.05 ms later")),
    "garbage collector": (
        N_("no pauses of Python's own"),
        N_("a tick now and then is late by milliseconds"),
    ),
    "SCHED_FIFO": (
        N_("goes before all other programs (SCHED_FIFO)"),
        N_("every other program can hold it up by milliseconds"),
    ),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class RightLine:
    """One right: ``cost`` is empty where it is granted; ``said`` is the service's own text."""

    granted: bool
    name: str
    cost: str
    said: str


def right_lines(rights: Sequence[Right], say: Say) -> tuple[RightLine, ...]:
    """Return the rights of the control process, those that are refused first."""
    lines = [_line(one, say) for one in rights]
    return tuple(sorted(lines, key=lambda one: one.granted))


def _line(right: Right, say: Say) -> RightLine:
    said = printable(right.text, LONGEST)
    name, cost = next(
        (words for begin, words in KNOWN.items() if right.text.startswith(begin)), ("", "")
    )
    return RightLine(
        granted=right.granted,
        name=say(name) if name else said,
        cost=say(cost) if cost and not right.granted else "",
        said=said,
    )
