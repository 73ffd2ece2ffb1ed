"""Step 9: shorter settle_s or memory_turns by bounded tries, and what each costs.

Halves as long as ripple falls by more than its error, then takes the double of the last one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from aff_runtime.app.card.evidence import Evidence, Try
from aff_runtime.app.card.figures import NAN, Figure, Sample, StepResult
from aff_runtime.app.card.measure.proof import enabled, root_sum
from aff_runtime.app.report.comparison.comparing import estimates
from aff_runtime.app.report.comparison.window import Window, roll_angle
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.units import plain
from aff_runtime.config.edited_text import EditedText
from aff_runtime.config.findings import KeyPath
from aff_runtime.config.models import Actuator, Site

MOST_TRIES = 6  # of one search, the setting of the site file among them
LEAST = 1.0
"""Shortest settle_s, s, and memory_turns, turns, that a site file takes."""
KIND = "candidate"
AT_MOST = " (at most: in the noise)"
NAMES = ("value", "ripple", "half", "noise", "peak")


class End(StrEnum):
    """Why a search ended, as the limit of its result says it."""

    NO_FALL = "ripple does not fall any more at half of it"
    ROSE = "ripple rises at half of it"
    NOISE = "ripple is in the noise: a shorter one cannot be told from it"
    LEAST = "ripple fell to the end: half of it is shorter than a site file takes"
    MOST = "ripple fell to the end: as many were tried as one search tries"
    CUT_OFF = "a try ended before it was measured"
    NO_TURNS = "ripple could not be measured"


RESULTS = (End.NO_FALL, End.ROSE, End.NOISE, End.LEAST)
"""Ends with which the step is done."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """What one setting did.

    Attributes
    ----------
    factor : of the value in the site file. ``value`` : the shortest that it makes, s or turns.
    ripple, half : amplitude of all corrected orders together, and half of its interval.
    noise : standard deviation of the signal without them. ``peak`` : largest correction.
    in_noise : none of the orders stands out: ``ripple`` is a bound, without an interval.
    ended : why the try ended before it was measured; empty where it was. ``worse`` : because
        ripple rose.
    """

    factor: float
    value: float
    ripple: float = NAN
    half: float = NAN
    noise: float = NAN
    peak: float = NAN
    in_noise: bool = False
    ended: str = ""
    worse: bool = False


def values_of(site: Site, actuator: str) -> Mapping[KeyPath, float]:
    """Return the keys that a search scales, with their values.

    Raises
    ------
    RefusedError
        There is no such actuator, or it corrects nothing.
    """
    found = site.actuators.get(actuator)
    if found is None:
        raise RefusedError(f"no actuator {actuator}; there are {', '.join(site.actuators)}")
    if found.uses_shape:
        return {("actuators", actuator, "memory_turns"): found.memory_turns}
    if not any(block.enabled for block in found.blocks):
        raise RefusedError(f"{actuator}: none of its blocks is enabled")
    return {
        ("actuators", actuator, "blocks", k, "settle_s"): block.settle_s
        for k, block in enumerate(found.blocks)
        if block.enabled
    }


def text_with(text: str, values: Mapping[KeyPath, float]) -> str:
    """Return a site file's text with other numbers in it; every other byte stays.

    Raises
    ------
    ConfigError
        A key does not stand in the file itself.
    """
    numbers = {path: plain(float(f"{value:.6g}")) for path, value in values.items()}
    return EditedText(text).with_values(numbers)


def end_of(table: Sequence[Candidate]) -> End | None:
    """Return why a search is over; None while it goes on."""
    if not table:
        return None
    last = table[-1]
    if last.ended:
        return End.ROSE if last.worse else End.CUT_OFF
    if not math.isfinite(last.ripple):
        return End.NO_TURNS
    if len(table) > 1 and not _improves(table[-2], last):
        return End.NO_FALL
    return _bound(last, len(table))


def _bound(last: Candidate, tries: int) -> End | None:
    """Return what keeps a search from going on though ripple fell; None where nothing does."""
    if last.in_noise:
        return End.NOISE
    if last.value / 2.0 < LEAST:
        return End.LEAST
    return End.MOST if tries >= MOST_TRIES else None


def next_factor(table: Sequence[Candidate]) -> float | None:
    """Return the factor to be tried next; None at the end of the search."""
    if end_of(table) is not None:
        return None
    return table[-1].factor / 2.0 if table else 1.0


def chosen(table: Sequence[Candidate]) -> float:
    """Return the factor that the search ends with; never a longer setting than the present one.

    Where ripple does not fall any more, the double of the last; where it fell to the end, the
    last itself: its double is known to be worse.
    """
    last = table[-1].factor
    return min(1.0, 2.0 * last) if end_of(table) in (End.NO_FALL, End.ROSE) else last


def _improves(before: Candidate, after: Candidate) -> bool:
    half = 0.0 if after.in_noise else after.half  # the ripple of noise is a bound by itself
    return before.ripple - after.ripple > math.hypot(before.half, half)


def candidate(evidence: Evidence, one: Try, window: Window | None) -> Candidate:
    """Return what a setting did in its window."""
    site = evidence.site
    value = one.factor * min(values_of(site, one.actuator).values())
    if window is None:
        ended = one.ended or "not measured"
        return Candidate(factor=one.factor, value=value, ended=ended, worse=one.worse)
    actuator = site.actuators[one.actuator]
    signal = window.readings(actuator.error.signal)
    if signal is None:
        raise RefusedError(f"{window.table.window}: no reading of {actuator.error.signal} in it")
    ends = [
        estimate
        for roll, orders in _orders(actuator).items()
        if (angle := roll_angle(window, window.section("rolls").section(roll))) is not None
        for estimate, _ in estimates(angle, signal, window, orders).values()
    ]
    ripple, half = root_sum(ends, 1.0) if ends else (NAN, NAN)
    power = float(np.nanvar(signal)) - 0.5 * sum(end.amplitude**2 for end in ends)
    sent = window.table.columns.get(f"correction_{one.actuator}_{_ending(actuator)}")
    peak = NAN if sent is None else float(np.nanmax(np.abs(sent)))
    return Candidate(
        factor=one.factor,
        value=value,
        ripple=ripple,
        half=half,
        noise=math.sqrt(max(0.0, power)),
        peak=peak,
        in_noise=not any(end.stands_out for end in ends),
    )


def measure(evidence: Evidence) -> StepResult:
    """Return the table of candidates, and the setting that it proposes."""
    if not evidence.tries:
        raise RefusedError("step 9: nothing was tried")
    windows = iter(evidence.windows)
    table = [candidate(evidence, t, next(windows) if t.measured else None) for t in evidence.tries]
    actuator = evidence.tries[0].actuator
    end, factor = end_of(table), chosen(table)
    proposals = [
        f"{'.'.join(map(str, path))}: {factor * value:g}  # was {value:g}"
        for path, value in values_of(evidence.site, actuator).items()
        if end in (*RESULTS, End.MOST) and factor < 1.0
    ]
    return StepResult(
        figures=tuple(_figures(evidence.site.actuators[actuator], table, end)),
        samples=(
            Sample(
                kind=KIND,
                of=actuator,
                columns=NAMES,
                rows=tuple((c.value, c.ripple, c.half, c.noise, c.peak) for c in table),
            ),
        ),
        proposals=tuple(proposals),
        remarks=tuple(f"{c.value:g} makes it worse: {c.ended}" for c in table if c.worse),
        missing=tuple(_missing(table, end)),
    )


def _missing(table: Sequence[Candidate], end: End | None) -> Iterator[str]:
    """Yield what the search still lacks: a try that ended early is not measured."""
    last = table[-1]
    if end is End.CUT_OFF:
        yield f"{last.value:g} was not measured to its end: {last.ended}; arm, and search again"
    elif end is End.NO_TURNS:
        yield (
            f"{last.value:g} has no ripple: fewer whole turns than an interval needs, with good "
            "angle and readings; look at the record, arm, and search again"
        )
    elif end is End.MOST:
        yield f"ripple still fell at {last.value:g}: keep it, arm, and search again from there"
    elif end is None:
        yield "the search was ended before its end; arm, and search again"


def _figures(actuator: Actuator, table: Sequence[Candidate], end: End | None) -> Iterator[Figure]:
    key, unit = ("memory_turns", "turns") if actuator.uses_shape else ("settle_s", "s")
    for one in table:
        at = f"{key} {one.value:g}"
        yield Figure(
            name=f"{at}: ripple of the corrected orders{AT_MOST if one.in_noise else ''}",
            value=one.ripple,
            unit=actuator.error.signal.rpartition("_")[2],
            low=NAN if one.in_noise else one.ripple - one.half,
            high=NAN if one.in_noise else one.ripple + one.half,
        )
        gain = one.noise / table[0].noise if table[0].noise > 0.0 else NAN
        yield Figure(name=f"{at}: noise gain, of the first", value=gain)
        yield Figure(name=f"{at}: largest correction", value=one.peak, unit=actuator.unit)
    yield Figure(
        name=f"{key} of the search",
        value=chosen(table) * table[0].value / table[0].factor if end in RESULTS else NAN,
        unit=unit,
        limit=end or "until ripple does not fall any more",
        good=True if end in RESULTS else None,
    )


def _orders(actuator: Actuator) -> Mapping[str, list[int]]:
    orders: dict[str, list[int]] = {}
    for block in enabled(actuator):
        orders.setdefault(block.roll, []).extend(block.orders)
    return orders


def _ending(actuator: Actuator) -> str:
    return "m_s" if actuator.output == "velocity_reference" else "N_m"
