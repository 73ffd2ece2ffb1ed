"""Step 9: shorter settle_s or memory_turns by bounded tries, and what each costs.

Halves as long as ripple falls by more than its error, then takes the double of the last one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from aff_runtime.app.card.evidence import Evidence, Try
from aff_runtime.app.card.figures import NAN, Figure, Finding, Sample
from aff_runtime.app.card.measure.proof import root_sum
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
NAMES = ("value", "ripple", "half", "noise", "peak")


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """What one setting did.

    Attributes
    ----------
    factor : of the value in the site file. ``value`` : the shortest that it makes, s or turns.
    ripple, half : amplitude of all corrected orders together, and half of its interval.
    noise : standard deviation of the signal without them. ``peak`` : largest correction.
    ended : why the try ended before it was measured; empty where it was. ``worse`` : because
        ripple rose.
    """

    factor: float
    value: float
    ripple: float = NAN
    half: float = NAN
    noise: float = NAN
    peak: float = NAN
    ended: str = ""
    worse: bool = False


def values_of(site: Site, actuator: str) -> Mapping[KeyPath, float]:
    """Return the keys that a search scales, with their values.

    Raises
    ------
    RefusedError
        There is no such actuator.
    """
    found = site.actuators.get(actuator)
    if found is None:
        raise RefusedError(f"no actuator {actuator}; there are {', '.join(site.actuators)}")
    if found.uses_shape:
        return {("actuators", actuator, "memory_turns"): found.memory_turns}
    return {
        ("actuators", actuator, "blocks", k, "settle_s"): block.settle_s
        for k, block in enumerate(found.blocks)
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


def next_factor(table: Sequence[Candidate]) -> float | None:
    """Return the factor to be tried next; None at the end of the search."""
    if not table:
        return 1.0
    last = table[-1]
    if last.ended or len(table) >= MOST_TRIES or last.value / 2.0 < LEAST:
        return None
    if len(table) > 1 and not _improves(table[-2], last):
        return None
    return last.factor / 2.0


def chosen(table: Sequence[Candidate]) -> float:
    """Return the factor that the search ends with: the double of the last; never a longer one."""
    return min(1.0, 2.0 * table[-1].factor)


def _improves(before: Candidate, after: Candidate) -> bool:
    return before.ripple - after.ripple > math.hypot(before.half, after.half)


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
    ripple, half = root_sum(ends, 1.0)
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
    )


def measure(evidence: Evidence) -> Finding:
    """Return the table of candidates, and the setting that it proposes."""
    if not evidence.tries:
        raise RefusedError("step 9: nothing was tried")
    windows = iter(evidence.windows)
    table = [candidate(evidence, t, next(windows) if t.measured else None) for t in evidence.tries]
    actuator = evidence.tries[0].actuator
    cut_off = [one for one in table if one.ended and not one.worse]
    is_over = next_factor(table) is None and not cut_off and math.isfinite(table[0].ripple)
    factor = chosen(table)
    proposals = [
        f"{'.'.join(map(str, path))}: {factor * value:g}  # was {value:g}"
        for path, value in values_of(evidence.site, actuator).items()
        if is_over and factor < 1.0
    ]
    return Finding(
        figures=tuple(_figures(evidence.site.actuators[actuator], table, is_over=is_over)),
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
        missing=tuple(_missing(cut_off, is_over=is_over)),
    )


def _missing(cut_off: Sequence[Candidate], *, is_over: bool) -> Iterator[str]:
    """Yield what the search still lacks: a try that ended early is not measured."""
    for one in cut_off:
        yield f"{one.value:g} was not measured to its end: {one.ended}; arm, and search again"
    if not is_over and not cut_off:
        yield "the search was ended before its end; arm, and search again"


def _figures(actuator: Actuator, table: Sequence[Candidate], *, is_over: bool) -> Iterator[Figure]:
    key, unit = ("memory_turns", "turns") if actuator.uses_shape else ("settle_s", "s")
    for one in table:
        at = f"{key} {one.value:g}"
        yield Figure(
            name=f"{at}: ripple of the corrected orders",
            value=one.ripple,
            unit=actuator.error.signal.rpartition("_")[2],
            low=one.ripple - one.half,
            high=one.ripple + one.half,
        )
        gain = one.noise / table[0].noise if table[0].noise > 0.0 else NAN
        yield Figure(name=f"{at}: noise gain, of the first", value=gain)
        yield Figure(name=f"{at}: largest correction", value=one.peak, unit=actuator.unit)
    yield Figure(
        name=f"{key} of the search",
        value=chosen(table) * table[0].value / table[0].factor if is_over else NAN,
        unit=unit,
        limit="ripple does not fall any more at half of it",
        good=True if is_over else None,
    )


def _orders(actuator: Actuator) -> Mapping[str, list[int]]:
    orders: dict[str, list[int]] = {}
    for block in actuator.blocks:
        orders.setdefault(block.roll, []).extend(block.orders)
    return orders


def _ending(actuator: Actuator) -> str:
    return "m_s" if actuator.output == "velocity_reference" else "N_m"
