"""Faults that can be injected into the wire and the PLC, and the board that times them.

Spelling: ``NAME[=ARGUMENT][@START][:DURATION]``, seconds of plant time; ``freeze@10:5`` freezes
the words from 10 s to 15 s. Without a duration the fault lasts until it is cleared.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from enum import StrEnum

from aff_runtime.base.errors import PlantError
from aff_runtime.base.signals import Status


class Fault(StrEnum):
    """Every fault, by the name that commands use."""

    MUTE = "mute"  # requests are taken and neither obeyed nor answered
    FREEZE = "freeze"  # answers keep the words of the first moment, heartbeat included
    TURNS = "turns"  # as freeze, but the words of two moments by turns
    DROP = "drop"  # connections are aborted, at once and at every further request
    REFUSE = "refuse"  # open connections are aborted and new ones refused
    DELAY = "delay"  # =MS: every answer comes late by this many milliseconds
    PARTIAL = "partial"  # the first half of each answer is sent
    BUSY = "busy"  # exception 6 to everything
    SWAP = "swap"  # 32-bit values in the other word order
    NAN = "nan"  # [=CHANNEL]: not a number; all tensions without a channel
    ABSURD = "absurd"  # [=CHANNEL]: a value far outside any line
    STUCK = "stuck"  # [=CHANNEL]: the value of the first moment
    SHORT = "short"  # well-framed answers that lack their last word
    TID = "tid"  # answers carry another transaction id
    RESTART = "restart"  # the PLC is gone for the duration (1 s) and starts afresh
    SPLICE = "splice"  # roll_id + 1 and SPLICE_ACTIVE for the duration (2 s)
    LOSE = "lose"  # [=PERCENT]: frames lost at random, both ways (20); CAN, UDP
    DOUBLE = "double"  # every answer or frame comes twice
    REORDER = "reorder"  # the frames of a scan come in reverse; CAN
    SECOND = "second"  # a second master writes zeros over the runtime's words
    LAST = "last"  # another idle master's words always come last before the PLC's scan
    THIRD = "third"  # a station puts a correction of its own in the place of ours before each scan
    ERRORS = "errors"  # error frames between the frames; CAN
    BUSOFF = "busoff"  # the controller reports bus-off and nothing passes; CAN
    SYNC = "sync"  # SYNC never arrives at the nodes; CANopen
    RESET = "reset"  # a node resets: boot-up, configuration gone; CANopen
    PERMISSIVE = "permissive"  # [=BIT]: a status bit is 0 (WEB_INTACT)


_DEFAULT_DURATION_S = {Fault.RESET: 0.0, Fault.DROP: 0.0, Fault.RESTART: 1.0, Fault.SPLICE: 2.0}
TAKES_CHANNEL = frozenset({Fault.NAN, Fault.ABSURD, Fault.STUCK})
"""Faults of a measured channel; without an argument of all tensions."""
_SEVERAL = TAKES_CHANNEL | {Fault.PERMISSIVE}
"""Faults of which several stand together: one per channel, one per status bit."""
_NUMBER = r"\d+(?:\.\d*)?|\.\d+"
_SPEC = re.compile(
    r"(?P<name>[a-z]+)(=(?P<argument>[\w.]+))?"
    rf"(@(?P<start>{_NUMBER}))?(:(?P<duration>{_NUMBER}))?"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultSpec:
    """One fault, its argument and its time window in plant seconds."""

    fault: Fault
    argument: str
    start_s: float
    duration_s: float

    @property
    def name(self) -> str:
        """Return name and argument, as a user spells them."""
        return f"{self.fault.value}={self.argument}" if self.argument else self.fault.value

    @property
    def end_s(self) -> float:
        """Return the time at which the fault ends, s; infinite when only clearing ends it."""
        return self.start_s + self.duration_s


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultEdge:
    """A fault that has just begun or ended."""

    spec: FaultSpec
    began: bool


def parse_fault(text: str) -> FaultSpec:
    """Read one fault as a user spells it.

    Raises
    ------
    PlantError
        The spelling, the name or the argument is unknown.
    """
    match = _SPEC.fullmatch(text)
    if match is None:
        raise PlantError(f"fault {text!r}: write NAME[=ARGUMENT][@START][:DURATION]")
    fault = fault_named(match["name"])
    duration = match["duration"]
    return FaultSpec(
        fault=fault,
        argument=_checked_argument(text, fault, match["argument"] or ""),
        start_s=float(match["start"] or 0.0),
        duration_s=float(duration) if duration else _DEFAULT_DURATION_S.get(fault, math.inf),
    )


def fault_named(name: str) -> Fault:
    """Return the fault of this name.

    Raises
    ------
    PlantError
        There is none; all are told.
    """
    try:
        return Fault(name)
    except ValueError as error:
        known = ", ".join(fault.value for fault in Fault)
        raise PlantError(f"fault {name!r}: unknown name; known are {known}") from error


def _checked_argument(text: str, fault: Fault, argument: str) -> str:
    if fault is Fault.DELAY:
        if re.fullmatch(_NUMBER, argument) is None:
            raise PlantError(f"fault {text!r}: write delay=MILLISECONDS")
    elif fault is Fault.LOSE:
        argument = argument or "20"
        if re.fullmatch(_NUMBER, argument) is None or float(argument) > 100.0:
            raise PlantError(f"fault {text!r}: write lose=PERCENT, 0 to 100")
    elif fault is Fault.PERMISSIVE:
        argument = argument or "WEB_INTACT"
        if argument not in Status.__members__:
            known = ", ".join(Status.__members__)
            raise PlantError(f"fault {text!r}: unknown status bit; known are {known}")
    elif argument and fault not in TAKES_CHANNEL:
        raise PlantError(f"fault {text!r}: {fault.value} takes no argument")
    return argument


class FaultBoard:
    """Knows which faults are active now.

    Faults of a channel or a status bit stand beside others of their kind; the same fault again
    begins anew. Of the rest one of a kind can be: another argument meanwhile is refused.

    Raises
    ------
    PlantError
        Two of the faults cannot be in force at once.
    """

    def __init__(self, specs: tuple[FaultSpec, ...] = ()) -> None:
        self._now_s = 0.0
        self._pending: list[FaultSpec] = []
        self._active: dict[tuple[Fault, str], FaultSpec] = {}
        self._kinds: dict[Fault, FaultSpec] = {}
        for spec in specs:
            self.inject(spec)

    def inject(self, spec: FaultSpec) -> FaultSpec:
        """Add a fault whose start counts from now; return it with its start in plant time.

        Raises
        ------
        PlantError
            One of its kind with another argument is in force meanwhile.
        """
        placed = replace(spec, start_s=self._now_s + spec.start_s)
        for other in (*self._active.values(), *self._pending):
            if _in_the_way(placed, other):
                until = (
                    "until it is cleared" if math.isinf(other.end_s) else f"to {other.end_s:g} s"
                )
                raise PlantError(
                    f"fault {placed.name!r}: {other.name!r} is in force meanwhile (from "
                    f"{other.start_s:g} s of plant time {until}) and would end silently; clear "
                    f"{other.fault.value!r} first"
                )
        self._pending.append(placed)
        return placed

    def clear(self, fault: Fault | None = None) -> None:
        """End all of one kind, or all, at the next step; forget those still to come."""
        gone = set(Fault) if fault is None else {fault}
        self._pending = [spec for spec in self._pending if spec.fault not in gone]
        for key, spec in self._active.items():
            if spec.fault in gone:
                self._active[key] = replace(spec, duration_s=0.0)

    def active(self, fault: Fault) -> bool:
        """Return whether ``fault`` is active now, with whatever argument."""
        return bool(self._kinds) and fault in self._kinds  # mostly none: asked ten times a scan

    def any_of(self, faults: frozenset[Fault]) -> bool:
        """Return whether at least one of ``faults`` is active now."""
        return not faults.isdisjoint(self._kinds)

    def argument(self, fault: Fault) -> str:
        """Return the argument of an active fault of which one can be, else an empty text."""
        spec = self._kinds.get(fault)
        return spec.argument if spec else ""

    def arguments(self, fault: Fault) -> list[str]:
        """Return the arguments of all active faults of a kind, in the order of their begin."""
        return [spec.argument for spec in self._active.values() if spec.fault is fault]

    def names(self) -> list[str]:
        """Return the active faults, as a user spells them."""
        return [spec.name for spec in self._active.values()]

    def advance(self, now_s: float) -> list[FaultEdge]:
        """Move to ``now_s``; return what ended, then what began by its start.

        A fault that begins anew ends before.
        """
        self._now_s = now_s
        over = [key for key, spec in self._active.items() if spec.end_s <= now_s]
        edges = [self._end(key) for key in over]
        begun = [spec for spec in self._pending if spec.start_s <= now_s]
        if begun:
            self._pending = [spec for spec in self._pending if spec.start_s > now_s]
        for spec in sorted(begun, key=lambda spec: spec.start_s):
            key = (spec.fault, spec.argument)
            if key in self._active:
                edges.append(self._end(key))
            self._active[key] = spec
            edges.append(FaultEdge(spec=spec, began=True))
        if edges:
            self._kinds = {spec.fault: spec for spec in self._active.values()}
        return edges

    def _end(self, key: tuple[Fault, str]) -> FaultEdge:
        return FaultEdge(spec=self._active.pop(key), began=False)


def _in_the_way(one: FaultSpec, other: FaultSpec) -> bool:
    """Return whether two faults of a kind of which one can be ask for the same time."""
    alike = one.fault is other.fault and one.fault not in _SEVERAL
    meet = one.start_s < other.end_s and other.start_s < one.end_s
    return alike and one.argument != other.argument and meet
