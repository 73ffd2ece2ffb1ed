"""A line speed reference from what was measured, where the run has none.

Between ramps it is what the speed rests at. A ramp is taken for a straight one: its middle is
where the measured travel puts it (a drive with an integral in its loop makes up what it lags), its
length the one that fits the measured speed best; where no straight one fits, the measured speed is
smoothed. Levels and travel come from the turns of a driven roller of fixed radius where its angle
is recorded: its drive divides the reference by that radius, and turns have no scale to be wrong.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.line.declared.declaration import Declaration, DriveSpeed, RollAngle
from sim_plant.line.declared.laws import draws
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.records.run_activity import box_mean, ramps

RUN = CRITERIA.model.run


def stand_in_speed(
    line: Declaration, columns: Mapping[str, Array], record: Recording
) -> tuple[Array, list[str]]:
    """Return a reference (samples,), m/s, and what is said of it.

    Raises
    ------
    PlantError
        No line speed is recorded either.
    """
    step_s = record.sample_time_s
    speeds = [
        s.channel
        for s in line.sensors
        if isinstance(s, DriveSpeed) and s.scale_radius_m is not None and s.channel in columns
    ]
    if not speeds:
        raise PlantError(
            f"{record.path}: holds neither a line speed nor its reference; map one of them in "
            "the site file and record again"
        )
    speed = columns[speeds[0]]
    rolled = _roller_travel(line, columns)
    source = speeds[0] if rolled is None else f"{speeds[0]}, with the turns of {rolled[0]},"
    travel = np.cumsum(speed) * step_s if rolled is None else rolled[1]
    straight, bent = _straight_parts(speed, travel, step_s)
    said = [f"no speed reference is recorded: the measured {source} stands in"]
    if bent:
        said.append(
            f"{bent} change{'s' * (bent != 1)} of speed: no straight ramp fits, smoothed there"
        )
    return straight, said


def _straight_parts(speed: Array, travel_m: Array, step_s: float) -> tuple[Array, int]:
    """Return levels joined by straight ramps (samples,), m/s, and how many had to be smoothed."""
    straight = box_mean(speed, max(1, round(RUN.smoothed_s / step_s)))
    changing = (
        box_mean(ramps(speed, step_s).astype(np.float64), round(RUN.rest_margin_s / step_s)) > 0.0
    )
    edges = [0, *(np.flatnonzero(np.diff(changing.astype(np.int8))) + 1), speed.size]
    parts = [slice(int(a), int(b)) for a, b in itertools.pairwise(edges)]
    levels: dict[int, float] = {}
    for k, part in enumerate(parts):
        length = part.stop - part.start
        if not changing[part.start] and length * step_s >= RUN.shortest_rest_s:
            metres = float(travel_m[part.stop - 1] - travel_m[part.start])
            levels[k] = straight[part] = metres / ((length - 1) * step_s)
    bent = 0
    for k, part in enumerate(parts):
        if changing[part.start]:
            ramp = None
            if k - 1 in levels and k + 1 in levels:
                metres = float(travel_m[part.stop] - travel_m[part.start])
                ramp = _ramp(speed[part], metres, (levels[k - 1], levels[k + 1]), step_s)
            bent += ramp is None
            straight[part] = straight[part] if ramp is None else ramp
    return straight, bent


def _ramp(
    speed: Array, travel_m: float, levels: tuple[float, float], step_s: float
) -> Array | None:
    """Return the straight ramp between two levels (samples,), m/s.

    None where the levels differ by less than ``straight_share``, or no straight ramp is that near
    to the measured speed.

    Equation: travel = v1 t_m + v2 (T - t_m) gives the middle t_m of a ramp symmetric about it.
    """
    before, after = levels
    if abs(after - before) < RUN.straight_share * max(abs(before), abs(after)):
        return None
    time_s = np.arange(speed.size) * step_s
    whole_s = speed.size * step_s
    middle_s = (after * whole_s - travel_m) / (after - before)
    longest_s = 2.0 * min(middle_s, whole_s - middle_s)
    if not longest_s > step_s:
        return None
    tries = [
        np.interp(time_s, [middle_s - 0.5 * d, middle_s + 0.5 * d], levels)
        for d in np.linspace(step_s, longest_s, RUN.ramp_lengths)
    ]
    best = min(tries, key=lambda ramp: float(np.sum((ramp - speed) ** 2)))
    error = float(np.sqrt(np.mean((best - speed) ** 2)))
    return best if error < RUN.straight_share * max(abs(before), abs(after)) else None


def _roller_travel(line: Declaration, columns: Mapping[str, Array]) -> tuple[str, Array] | None:
    """Return channel and surface travel, m, of a driven roller of fixed radius; None without one.

    One whose reference is a draw is left out: it does not run at the line's speed.
    """
    drawn = {d.roller for d in line.control.drives if draws(d.speed_reference)}
    fixed = {r.name: r.radius_m for r in line.rollers if r.kind == "driven"}
    for sensor in line.sensors:
        if not isinstance(sensor, RollAngle) or sensor.roller in drawn:
            continue
        if sensor.roller in fixed and sensor.channel in columns:
            return sensor.channel, columns[sensor.channel] * fixed[sensor.roller]
    return None
