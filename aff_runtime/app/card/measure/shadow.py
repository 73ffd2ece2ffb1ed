"""Step 6: ten minutes of shadow: ticks, and each roll's frequency against the spectrum's peaks."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import NAN, Array, Figure, StepResult, at_least, at_most
from aff_runtime.app.report.comparison.comparing import tensions
from aff_runtime.app.report.comparison.window import RollAngle, Window, orders_of, roll_angle
from aff_runtime.base.signals import State

SHORTEST_S, LIMIT_PERCENT = 599.0, 1.0
"""Ten minutes, less the second that the end of a record may still lack; of a peak's frequency."""
SEARCHED = 0.04
"""A peak is looked for within this share of an order; beyond, it is another body's."""
STANDS_OUT = 5.0
"""A peak stands out when it is so many times the median of the spectrum around it."""
PER_TURN = 16
"""Samples per period of the order that is looked for."""
FEWEST_TURNS = 50  # of a roll; with fewer nothing is compared


def measure(evidence: Evidence) -> StepResult:
    """Return length, missed ticks, overruns, and per roll the frequency's difference."""
    window = evidence.window
    columns = window.table.columns
    time_s, missed = columns["time_s"], columns.get("missed_count", np.empty(0))
    seconds = float(time_s[-1] - time_s[0])
    lost = float(np.nanmax(missed) - np.nanmin(missed)) if missed.size else NAN
    overruns = sum(row.get("name") == "OVERRUN" for row in window.table.events)
    share = 100.0 * window.in_state(State.SHADOW)
    figures = [
        Figure(
            name="length of the window",
            value=seconds,
            unit="s",
            limit=f"at least {SHORTEST_S:g} s",
            good=at_least(seconds, SHORTEST_S),
        ),
        Figure(name="in shadow", value=share, unit="%", limit="at least 99 %", good=share >= 99.0),
        Figure(name="ticks missed", value=lost, limit="0", good=at_most(lost, 0.0)),
        Figure(name="overruns", value=float(overruns), limit="0", good=overruns == 0),
    ]
    missing: list[str] = []
    for roll in window.section("rolls").data:
        angle = roll_angle(window, window.section("rolls").section(roll))
        if angle is None:
            missing.append(f"{roll}: its angle is not known in the window")
            continue
        figures.append(_frequency(window, roll, angle))
    return StepResult(
        figures=tuple(figures), missing=tuple(missing), remarks=(*window.labels, *_silent(figures))
    )


def _silent(figures: list[Figure]) -> Iterator[str]:
    for figure in figures:
        if not figure.needed:
            yield f"{figure.name}: no ripple of it stands out in any tension, nothing to compare"


def _frequency(window: Window, roll: str, angle: RollAngle) -> Figure:
    """Return how far the clearest peak of a roll lies from its order, in percent."""
    peaks = [
        peak
        for _, values in tensions(window)
        for order in orders_of(window.site, roll)
        if (peak := peak_near(angle.angle_rad, values, angle.good, order)) is not None
    ]
    best = max(peaks, key=lambda peak: peak[2], default=(NAN, NAN, 0.0))
    error, half = 100.0 * best[0], 100.0 * best[1]
    return Figure(
        name=f"{roll}: frequency of the spectrum's peak over that of the roll, less 1",
        value=error,
        unit="%",
        low=error - half,
        high=error + half,
        limit=f"within {LIMIT_PERCENT:g} %",
        good=at_most(abs(error), LIMIT_PERCENT),
        needed=math.isfinite(error),
    )


def peak_near(
    angle_rad: Array, values: Array, good: object, order: int
) -> tuple[float, float, float] | None:
    """Return where the highest peak near an order lies; None where none stands out.

    Its place over the order less 1, half of the resolution, and how many times the median it is.
    Equation: the readings over even steps of the roll's own angle, so that a changing radius
    moves no peak, under a Hann window; |sum x e^{-j m theta}| for m around the order.
    """
    turns = float(angle_rad[-1] - angle_rad[0]) / math.tau
    if turns < FEWEST_TURNS or not bool(np.mean(np.asarray(good)) > 0.9):
        return None
    known = np.isfinite(values)
    count = math.ceil(turns * order * PER_TURN)
    even = np.linspace(angle_rad[0], angle_rad[-1], count)
    evenly = np.interp(even, angle_rad[known], values[known])
    swing = (evenly - evenly.mean()) * np.hanning(count)
    sizes = np.abs(np.fft.rfft(swing))
    places = np.arange(sizes.size) / turns
    around = np.abs(places / order - 1.0) < 3.0 * SEARCHED
    near = np.flatnonzero(np.abs(places / order - 1.0) < SEARCHED)
    if near.size < 3:
        return None
    at = int(near[np.argmax(sizes[near])])
    floor = float(np.median(sizes[around]))
    clear = float(sizes[at]) / max(floor, 1e-300)
    if clear < STANDS_OUT or not 0 < at < sizes.size - 1:
        return None
    before, top, after = (math.log(max(size, 1e-300)) for size in sizes[at - 1 : at + 2])
    bend = before - 2.0 * top + after
    shift = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
    place = (at + shift) / turns
    return place / order - 1.0, 0.5 / turns / order, clear
