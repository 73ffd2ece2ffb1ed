"""Step 11: each way of being tripped: time to zero, bump of the tension, and what comes after.

One measurement is of one trip, which is typed; of a trip that ends the record its time is too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import NAN, Figure, Sample, StepResult, at_most
from aff_runtime.app.card.typed_values import NotTypedError
from aff_runtime.app.report.comparison.window import Window, any_correction
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.runs.roll_changes import roll_changes
from aff_runtime.base.signals import State

COMES_BACK = {
    "web_break": True,
    "splice": True,
    "stop": True,
    "restart": False,
    "bypass": False,
    "kill": False,
    "cable": False,
    "plc_stop": False,
}
"""Trips, and whether the correction comes back by itself.

``restart`` is of the service (``systemctl restart aff-runtime``), ``kill`` is ``kill -9`` of the
control process, ``bypass`` is an operator's; the PLC takes a permissive away (``web_break``), says
that a new roll is joined (``splice``) or that the line stops (``stop``); ``cable`` is that of the
wire, pulled, and ``plc_stop`` ends the PLC's program.
"""
ENDS_RECORD = ("restart", "kill")
"""Trips that end the control process, and the record with it: what the PLC does then is in no row.

When it shows zero is typed, and whether the correction comes back is not measured.
"""
STALE = ("cable", "plc_stop")
"""Trips whose cause is the last fresh reading; of the others, a change of a word."""
TENSION_STAYS = ("splice", "bypass")
"""Trips of which the bump of the tension is judged."""
TYPED = ("trip", "time")
LIMIT_MS, BUMP_SIGMAS = 300.0, 5.0
BEFORE_S, AFTER_S, CAUSE_S, STAYS_S = 5.0, 1.0, 1.0, 5.0
"""Steps of the tension are compared from ``BEFORE_S`` before the cause to ``AFTER_S`` after it; a
word that changed within ``CAUSE_S`` before the trip is its cause; a correction that is still off
``STAYS_S`` after it stays off."""
KIND, NAMES = "trip", ("time_ms", "error_ms", "bump_sigmas", "came_back")
"""Numbers of a sample. ``error_ms``: two cycles."""


def measure(evidence: Evidence) -> StepResult:
    """Return the figures of every trip that was made; the missing ones are named."""
    trip = evidence.typed.word("trip")
    if trip not in COMES_BACK:
        raise NotTypedError(f"step 11: type which: trip={' or '.join(COMES_BACK)}")
    fresh = _typed_sample(evidence, trip) if trip in ENDS_RECORD else _sample(evidence, trip)
    last = {one.of: one for one in (*evidence.former, fresh) if one.kind == KIND}
    figures = [figure for one in last.values() for figure in _figures(one)]
    missing = [f"make the trip, and type trip={name}" for name in COMES_BACK if name not in last]
    return StepResult(figures=tuple(figures), samples=(fresh,), missing=tuple(missing))


def bump_sigmas(before: Sequence[float], after: Sequence[float]) -> float:
    """Return the largest step of readings after, over the standard deviation of steps before.

    Steps from one reading to the next: ripple that comes back slowly is no bump.
    """
    usual, steps = np.diff(before), np.abs(np.diff(after))
    sigma = float(np.std(usual)) if usual.size > 10 else 0.0
    return float(steps.max()) / sigma if sigma > 0.0 and steps.size else NAN


def _typed_sample(evidence: Evidence, trip: str) -> Sample:
    time_ms = 1e3 * evidence.typed.number("time", "s")
    if not math.isfinite(time_ms):
        raise NotTypedError(
            f"step 11: {trip} ends the record: type when the PLC shows zero: time=80 ms"
        )
    return Sample(kind=KIND, of=trip, names=NAMES, numbers=(time_ms, NAN, NAN, NAN))


def _sample(evidence: Evidence, trip: str) -> Sample:
    window = evidence.window
    columns = window.table.columns
    time_s, state = columns["time_s"], columns["state"]
    falls = 1 + np.flatnonzero((state[:-1] == State.ACTIVE) & (state[1:] != State.ACTIVE))
    if not falls.size:
        raise RefusedError(f"{window.table.window}: the correction is not tripped in it")
    at = int(falls[-1])  # those before are of other trips, which were measured
    cause_s = _cause_s(window, at, trip)
    silent = ~any_correction(columns)
    zeros = at + np.flatnonzero(silent[at:])
    time_ms = 1e3 * (float(time_s[zeros[0]]) - cause_s) if zeros.size else NAN
    later = time_s > time_s[at] + STAYS_S
    came_back = bool(np.any(state[at:] == State.ACTIVE))
    if not came_back and not later.any():
        raise RefusedError(
            f"{window.table.window}: ends less than {STAYS_S:g} s after the trip; take it longer"
        )
    return Sample(
        kind=KIND,
        of=trip,
        names=NAMES,
        numbers=(
            time_ms,
            2e3 * evidence.site.cycle_s,
            _bump(evidence, window, cause_s) if trip in TENSION_STAYS else NAN,
            float(came_back),
        ),
    )


def _cause_s(window: Window, at: int, trip: str) -> float:
    """Return when the cause was there, s: the last fresh reading, or the last change of a word."""
    columns = window.table.columns
    time_s = columns["time_s"]
    if trip in STALE:
        fresh = np.flatnonzero(columns["fresh"][: at + 1] > 0.0)
        return float(time_s[fresh[-1]] if fresh.size else time_s[at])
    changes = (np.diff(columns["status"][: at + 1]) != 0.0) | (
        roll_changes(columns["roll_id"][: at + 1])[1:]
    )
    near = 1 + np.flatnonzero(changes & (time_s[1 : at + 1] > time_s[at] - CAUSE_S))
    return float(time_s[near[-1]] if near.size else time_s[at])


def _bump(evidence: Evidence, window: Window, cause_s: float) -> float:
    bumps = []
    for actuator in evidence.site.actuators.values():
        values = window.readings(actuator.error.signal)
        if values is not None:
            since = window.time_s - cause_s
            before = values[(since >= -BEFORE_S) & (since < 0.0)]
            after = values[(since >= 0.0) & (since <= AFTER_S)]
            bumps.append(bump_sigmas(before.tolist(), after.tolist()))
    finite = [one for one in bumps if math.isfinite(one)]
    return max(finite, default=NAN)


def _figures(sample: Sample) -> Iterator[Figure]:
    trip, error_ms = sample.of, sample.number("error_ms")
    time_ms = sample.number("time_ms")
    yield Figure(
        name=f"{trip}: time to zero{' (typed)' if trip in ENDS_RECORD else ''}",
        value=time_ms,
        unit="ms",
        low=time_ms - error_ms,
        high=time_ms + error_ms,
        limit=f"at most {LIMIT_MS:g} ms",
        good=at_most(time_ms, LIMIT_MS),
    )
    if trip in TENSION_STAYS:
        bump = sample.number("bump_sigmas")
        yield Figure(
            name=f"{trip}: largest step of the tension between two readings within 1 s",
            value=bump,
            unit="standard deviations of such steps before",
            limit=f"at most {BUMP_SIGMAS:g}",
            good=at_most(bump, BUMP_SIGMAS),
        )
    back = sample.number("came_back")
    if math.isfinite(back):
        wanted = COMES_BACK[trip]
        yield Figure(
            name=f"{trip}: {'comes back by itself' if wanted else 'stays off until armed'}",
            value=back,
            limit="1" if wanted else "0",
            good=bool(back) == wanted,
        )
