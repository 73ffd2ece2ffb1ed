"""The steps of the card: one frozen row each, from the machine to the proof."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import StrEnum

from aff_runtime.app.card.evidence import Evidence, Need
from aff_runtime.app.card.figures import StepResult
from aff_runtime.app.card.measure import (
    limits,
    load_cell,
    machine,
    orders,
    plug,
    proof,
    response,
    ripple,
    search,
    shadow,
    trips,
    words,
)
from aff_runtime.app.card.site_parts import ALL, Part
from aff_runtime.base.errors import RefusedError


class Basis(StrEnum):
    """What a step rests on: when it has changed, the step is due again."""

    SITE = "site file"
    PLC = "program of the PLC"
    ROLL = "roll"
    RESPONSES = "measured responses"
    MACHINE = "machine"


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One row.

    Attributes
    ----------
    measured, unit, limit : what comes out, in words.
    rests_on : what turns it to "again". ``parts`` : of the site file, those alone; never keys
        that this step or a later one asks to edit.
    needs : what has to be gathered.
    seconds : of the record that are looked at where no window is named; 0: no record.
    begins_anew : of the newest rows those since the last change of settings are looked at: what
        is looked for happens once.
    typed : names that may be typed.
    """

    number: int
    title: str
    measured: str
    unit: str
    limit: str
    rests_on: tuple[Basis, ...]
    parts: tuple[Part, ...] = ()
    needs: tuple[Need, ...] = ()
    seconds: float = 0.0
    begins_anew: bool = False
    typed: Callable[[Evidence], Iterable[str]] = lambda _: ()
    measure: Callable[[Evidence], StepResult]


_WORDS = (Basis.SITE, Basis.PLC)
_LOOP = (Basis.SITE, Basis.PLC, Basis.RESPONSES)
_ROLL = (*_LOOP, Basis.ROLL)
_RECORD = (Need.RECORD,)
_READ = (Part.CHANNELS, Part.SIGNALS)
_BUS = (*_READ, Part.WIRE, Part.LINE)
_TURN = (*_BUS, Part.ROLLS)
_LAW = (*_TURN, Part.LAW)
SEARCH, SEARCH_TYPED = 9, ("actuator",)
"""The step that tries settings; who runs it does so before it is measured."""

STEPS: tuple[Step, ...] = (
    Step(
        number=0,
        title="Machine: rights, processors, clock",
        measured="99 % point of the wake-up, rights granted",
        unit="us",
        limit="at most 500 us over 60 s, SCHED_FIFO granted",
        rests_on=(Basis.MACHINE,),
        needs=(Need.RECORD, Need.SERVICE),
        seconds=61.0,
        measure=machine.measure,
    ),
    Step(
        number=1,
        title="Load cell: zero without web, span weight",
        measured="mean and deviation at no load and with the weight",
        unit="% of span",
        limit="within 1 % of span",
        rests_on=_WORDS,
        parts=_READ,
        needs=_RECORD,
        seconds=10.0,
        typed=lambda _: load_cell.TYPED,
        measure=load_cell.measure,
    ),
    Step(
        number=2,
        title="Words: heartbeat, echo, tension, speed, radius",
        measured="longest rest of the heartbeat, difference from the display",
        unit="%",
        limit="within 1 %, the heartbeat moves, the echo is seen",
        rests_on=_WORDS,
        parts=(*_TURN, Part.FRESHNESS),
        needs=_RECORD,
        seconds=10.0,
        typed=words.typed_names,
        measure=words.measure,
    ),
    Step(
        number=3,
        title="Limits, in the PLC first",
        measured="limit against the PLC's, counts of its word, warnings",
        unit="counts",
        limit="at most the PLC's, at least 5 counts, every warning understood",
        rests_on=_WORDS,
        parts=(Part.LIMITS, Part.SIGNALS, Part.WIRE),
        typed=limits.typed_names,
        measure=limits.measure,
    ),
    Step(
        number=4,
        title="Watchdog of drive or gateway",
        measured="reaction and its time, typed",
        unit="ms",
        limit="zero or ramp, at most 300 ms",
        rests_on=(Basis.PLC,),
        typed=lambda _: limits.WATCHDOG_TYPED,
        measure=limits.watchdog,
    ),
    Step(
        number=5,
        title="Shadow, and the plug pulled",
        measured="PLC_STALE after the heartbeat's last movement",
        unit="ms",
        limit="fault_after_ms; with the fade 300 ms",
        rests_on=_WORDS,
        parts=(Part.FRESHNESS, Part.LINE, Part.WIRE),
        needs=_RECORD,
        seconds=120.0,
        begins_anew=True,
        typed=lambda _: plug.TYPED,
        measure=plug.measure,
    ),
    Step(
        number=6,
        title="Shadow for ten minutes",
        measured="frequency of each roll against the spectrum, missed ticks, overruns",
        unit="%",
        limit="within 1 % per roll, none missed, no overrun",
        rests_on=_WORDS,
        parts=_TURN,
        needs=_RECORD,
        seconds=601.0,
        measure=shadow.measure,
    ),
    Step(
        number=7,
        title="Response at three speeds or radii, twice each",
        measured="difference of repeats over their stated error, coherence, sign",
        unit="standard errors",
        limit="at most 2, coherence at least 0.73, sign as the geometry has it",
        rests_on=_LOOP,
        parts=_TURN,
        typed=response.typed_names,
        measure=response.measure,
    ),
    Step(
        number=8,
        title="First order at a quarter of its limit, or the shape with all orders",
        measured="ripple over time from arming",
        unit="dB",
        limit="falls within 3 settle times or 10 turns",
        rests_on=_LOOP,
        parts=_LAW,
        needs=_RECORD,
        seconds=600.0,
        begins_anew=True,
        measure=ripple.measure,
    ),
    Step(
        number=SEARCH,
        title="Search of settle_s or memory_turns",
        measured="table of candidates: ripple, noise gain, largest correction",
        unit="N",
        limit="the shortest that is not worse, doubled",
        rests_on=_LOOP,
        parts=_LAW,
        needs=_RECORD,
        typed=lambda _: SEARCH_TYPED,
        measure=search.measure,
    ),
    Step(
        number=10,
        title="More orders",
        measured="state and reduction of every order",
        unit="dB",
        limit="none held that leaves ripple",
        rests_on=_LOOP,
        parts=(*_LAW, Part.LIMITS, Part.TUNING),
        needs=(Need.SERVICE, Need.RECORD),
        seconds=120.0,
        begins_anew=True,
        measure=orders.measure,
    ),
    Step(
        number=11,
        title="Trips",
        measured="time to zero, bump of the tension",
        unit="ms",
        limit="at most 300 ms, no bump, comes back or stays off as the trip says",
        rests_on=_WORDS,
        parts=(*_TURN, Part.PERMISSIVES, Part.FRESHNESS, Part.LIMITS),
        needs=_RECORD,
        seconds=120.0,
        begins_anew=True,
        typed=lambda _: trips.TYPED,
        measure=trips.measure,
    ),
    Step(
        number=12,
        title="Proof on the running web: off, on, off, on",
        measured="whole turns of each part, reduction of every corrected order",
        unit="dB",
        limit="20 turns each, at least what was promised",
        rests_on=_ROLL,
        parts=ALL,
        needs=_RECORD,
        seconds=1800.0,
        begins_anew=True,
        typed=lambda _: proof.TYPED,
        measure=proof.measure,
    ),
)


def step_of(number: int) -> Step:
    """Return the row of a step.

    Raises
    ------
    RefusedError
        There is none.
    """
    for step in STEPS:
        if step.number == number:
            return step
    raise RefusedError(f"no step {number}; the card has {STEPS[0].number} to {STEPS[-1].number}")
