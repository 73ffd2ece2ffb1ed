"""Step 8: from arming on, ripple falls: one order of the plain law, or a whole shape."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import Figure, Sample, StepResult
from aff_runtime.app.card.measure.phases import Phase, phases
from aff_runtime.app.card.measure.proof import (
    SETTLES,
    SLOWEST_M_S,
    by_key,
    corrected,
    enabled,
    reduction_figure,
    rise_shares,
    surely_fell,
)
from aff_runtime.app.report.comparison.comparing import compare
from aff_runtime.app.report.comparison.turns import order_per_turn
from aff_runtime.app.report.comparison.window import Window, roll_angle
from aff_runtime.base.order_columns import RESPONSE_RATIO, is_part, order_columns
from aff_runtime.base.runs.table import read_table
from aff_runtime.config.models import Actuator

TURNS = 10.0  # of its roll, that a shape law is given to settle
RATIO = (0.5, 2.0)  # within which the median of ``gain_of_P`` shall be
_MOST_TURNS = 400  # a course of twice as many or more is thinned to this many, or a few more
KIND, COLUMNS = "course", ("time_s", "amplitude")


def measure(evidence: Evidence) -> StepResult:
    """Return the reduction once the settling time is over, its course, and the response ratio."""
    window = evidence.window
    found = phases(window)
    armings = [k for k in range(len(found) - 1) if not found[k].on and found[k + 1].on]
    if not armings:
        return StepResult(
            figures=(), missing=("no arming in the window: begin it some turns before",)
        )
    off, on = found[armings[-1]], found[armings[-1] + 1]
    waits_s = max(_wait_s(evidence, one, window) for one in evidence.site.actuators.values())
    if not on.to_s - on.from_s > waits_s + 1.0:
        return StepResult(
            figures=(), missing=(f"stay armed for more than {waits_s:.0f} s, and some turns",)
        )
    both = compare(off.of(window), on.later(waits_s).of(window))
    wanted = corrected(evidence.site)
    rows = by_key(both, wanted)
    shares = rise_shares(rows)
    orders = [reduction_figure(key, [row.change], shares[key]) for key, row in rows.items()]
    settling = Figure(name="left to settle from arming on", value=waits_s, unit="s")
    return StepResult(
        figures=(settling, *orders, *_ratios(on, window)),
        samples=tuple(_courses(evidence, window, off, on)),
        missing=tuple(_no_fall(orders)),
        remarks=both.labels,
    )


def _no_fall(orders: Sequence[Figure]) -> Iterator[str]:
    """Yield what the step still waits for, if no corrected order fell."""
    if all(one.good is None for one in orders):
        yield "no corrected order stands out of the noise"
    elif not any(surely_fell(one) for one in orders):
        yield "no corrected order fell by more than its error: stay off, and on, for more turns"


def _wait_s(evidence: Evidence, actuator: Actuator, window: Window) -> float:
    """Return three settle times, or ten turns of a shape's roll at the window's mean speed, s."""
    if not actuator.uses_shape or actuator.drive is None:
        return SETTLES * max((block.settle_s for block in enabled(actuator)), default=0.0)
    roll = evidence.site.rolls[actuator.drive.roll]
    speed = window.speed
    mean = abs(float(np.nanmean(speed))) if speed is not None else evidence.site.speed_max_m_s
    radius = window.readings(roll.radius or "")
    radius_m = roll.largest_radius_m if radius is None else float(np.nanmean(radius))
    return TURNS * math.tau * radius_m / max(mean, SLOWEST_M_S)


def _ratios(on: Phase, window: Window) -> Iterator[Figure]:
    """Yield the lowest and highest median of the response ratio that the shape law follows."""
    columns = read_table(on.of(window), keep=lambda name: is_part(name, RESPONSE_RATIO)).columns
    ratios = [columns[o.response_ratio] for o in order_columns(columns) if o.response_ratio]
    known = (ratio[np.isfinite(ratio)] for ratio in ratios)
    medians = [float(np.median(ratio)) for ratio in known if ratio.size]
    if medians:
        for which, value in (("lowest", min(medians)), ("highest", max(medians))):
            yield Figure(
                name=f"{RESPONSE_RATIO}, {which} of the orders",
                value=value,
                limit=f"{RATIO[0]:g} to {RATIO[1]:g}",
                good=RATIO[0] <= value <= RATIO[1],
            )


def _courses(evidence: Evidence, window: Window, off: Phase, on: Phase) -> Iterator[Sample]:
    """Yield the amplitude of the first order of every block, turn by turn, from off to on.

    The times of the turns assume constant speed: they divide the window evenly.
    """
    inside = (window.time_s >= off.from_s) & (window.time_s < on.to_s)
    for actuator in evidence.site.actuators.values():
        values = window.readings(actuator.error.signal)
        for block in enabled(actuator):
            angle = roll_angle(window, window.section("rolls").section(block.roll))
            if values is None or angle is None:
                continue
            order = block.orders[0]
            good = angle.good & inside & np.isfinite(values)
            turns, _ = order_per_turn(angle.angle_rad, np.nan_to_num(values), good, [order])
            if len(turns) < 2:
                continue
            times = np.linspace(off.from_s, on.to_s, len(turns)) - on.from_s
            step = max(1, len(turns) // _MOST_TURNS)
            yield Sample(
                kind=KIND,
                of=f"{actuator.error.signal}, {block.roll} {order}x",
                columns=COLUMNS,
                rows=tuple(
                    (float(t), float(abs(turn[0])))
                    for t, turn in zip(times[::step], turns[::step], strict=True)
                ),
            )
