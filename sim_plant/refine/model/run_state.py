"""The line as it was when a part of a run began: radii, sample time, resolution of its words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.line.declared.declaration import (
    Declaration,
    DriveSpeed,
    RollAngle,
    RollRadius,
    Sensor,
)
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.recording import Recording

RUN = CRITERIA.model.run
SPEED_REF = "line_speed_ref_m_s"


def at_run(line: Declaration, record: Recording) -> Declaration:
    """Return the line with the run's sample time, radii at its start and resolution of its words.

    A record that is no part of a run leaves the line as it is.

    Raises
    ------
    PlantError
        A roll has a radius that this line's cannot have.
    """
    if record.run is None:
        return line
    radii = line.initial_radii_m
    first, last = line.rollers[0].name, line.rollers[-1].name
    unwind = _radius_at_start(line, record, first) or radii.unwind
    rewind = _radius_at_start(line, record, last) or _balance(line, unwind)
    for name, radius in ((first, unwind), (last, rewind)):
        if not radii.core <= radius < RUN.largest_cores * radii.core:
            raise PlantError(
                f"{record.path}: {name} begins at a radius of {radius:.4g} m, the line file "
                f"declares a core of {radii.core:g} m: is it a run of another line?"
            )
    _check_turning(line, record, {first: unwind, last: rewind})
    at_start = {0: unwind, len(line.rollers) - 1: rewind}
    rollers = [
        r.model_copy(update={"radius_m": at_start[k]}) if k in at_start else r
        for k, r in enumerate(line.rollers)
    ]
    steps = record.run.site.count_sizes
    return line.model_copy(
        update={
            "sample_time_s": round(record.sample_time_s, 6),
            "initial_radii_m": radii.model_copy(update={"unwind": unwind, "rewind": rewind}),
            "rollers": tuple(rollers),
            "sensors": tuple(_as_recorded(s, steps) for s in line.sensors),
        }
    )


def _check_turning(line: Declaration, record: Recording, radii: Mapping[str, float]) -> None:
    """Refuse a run in which a body turns as one of another radius would; ``radii``: at its start.

    A roll of web turns as its mean radius makes it, that of its first and last turn.
    """
    web_m = abs(float(np.sum(record.columns[SPEED_REF][:-1]))) * record.sample_time_s
    wound_m2 = web_m * line.web.thickness_m / math.pi
    change_m2 = dict(zip(radii, (-wound_m2, wound_m2), strict=True))  # of the radius squared
    for roller in line.rollers:
        radius = radii.get(roller.name, roller.radius_m)
        if roller.name in change_m2:
            radius = 0.5 * (radius + math.sqrt(max(radius**2 + change_m2[roller.name], 0.0)))
        turned = next(_turning(line, record, roller.name, record.samples), 0.0)
        if web_m < RUN.least_web_m or abs(turned) < RUN.least_turn_rad:
            continue
        seen = web_m / abs(turned)
        if abs(seen / radius - 1.0) > RUN.other_share:
            raise PlantError(
                f"{record.path}: {roller.name} turns as a body of {seen:.4g} m, its radius is "
                f"{radius:.4g} m by {'the run' if roller.name in radii else 'the line file'}: "
                "is it a run of another line, or is a scale of its site file wrong?"
            )


def word_steps(record: Recording, channels: Sequence[str]) -> dict[str, float]:
    """Return one count, SI, of each channel's word, angles and unknown ones left out."""
    if record.run is None:
        return {}
    steps = record.run.site.count_sizes
    angles = "_angle_rad"  # their count is in the declaration, see ``at_run``
    return {
        name: steps[name]
        for name in channels
        if steps.get(name, 0.0) > 0.0 and not name.endswith(angles)
    }


def _as_recorded(sensor: Sensor, steps: Mapping[str, float]) -> Sensor:
    """Return an angle at the resolution of its word, if that is coarser."""
    step = steps.get(sensor.channel, 0.0)
    if isinstance(sensor, RollAngle) and step > sensor.lsb_rad:
        return sensor.model_copy(update={"lsb_rad": step})
    return sensor


def _radius_at_start(line: Declaration, record: Recording, roller: str) -> float | None:
    """Return a roll's radius at the start, m: as recorded, else from how it turns.

    Equation: metres run over angle turned is the mean of the radii at both ends; the web of half
    that angle lies between mean and start, h angle / 4 pi.
    """
    for sensor in line.sensors:
        if isinstance(sensor, RollRadius) and sensor.roller == roller:
            values = record.columns.get(sensor.channel)
            if values is not None:
                return _first_value(values, _angle_of(line, record, roller), record.sample_time_s)
    rows = min(record.samples, max(2, round(RUN.turning_s / record.sample_time_s)))
    web_m = float(np.sum(record.columns[SPEED_REF][: rows - 1])) * record.sample_time_s
    grows = 1.0 if roller == line.rollers[-1].name else -1.0
    for turned in _turning(line, record, roller, rows):
        if turned > RUN.least_turn_rad:
            return web_m / turned - grows * line.web.thickness_m * turned / (4.0 * math.pi)
    return None


def _first_value(radius_m: Array, angle_rad: Array | None, step_s: float) -> float:
    """Return where a radius begins that changes evenly with the roll's angle.

    The whole record counts where the angle is recorded: a count of the word is 1e-4 of the
    radius, which would put the roll out of step with its own encoder.
    """
    if angle_rad is not None and float(np.ptp(angle_rad)) > 2.0 * math.pi:
        return float(np.polyfit(angle_rad - angle_rad[0], radius_m, 1)[1])
    rows = min(radius_m.size, max(2, round(RUN.start_s / step_s)))
    return float(np.polyfit(np.arange(rows, dtype=np.float64), radius_m[:rows], 1)[1])


def _angle_of(line: Declaration, record: Recording, roller: str) -> Array | None:
    """Return a roll's recorded angle, rad, or None."""
    for sensor in line.sensors:
        if isinstance(sensor, RollAngle) and sensor.roller == roller:
            return record.columns.get(sensor.channel)
    return None


def _turning(line: Declaration, record: Recording, roller: str, rows: int) -> Iterator[float]:
    """Yield by what angle, rad, the roll turns in the first ``rows``, the best source first."""
    for sensor in line.sensors:
        values: Array | None = record.columns.get(sensor.channel)
        if values is None or sensor.roller != roller:
            continue
        if isinstance(sensor, RollAngle):
            yield float(values[rows - 1] - values[0])
        elif isinstance(sensor, DriveSpeed) and sensor.scale_radius_m is None:
            yield float(np.sum(values[: rows - 1])) * record.sample_time_s


def _balance(line: Declaration, unwind_m: float) -> float:
    """Return the rewind's radius, m, when the unwind has this one: web that left is on it."""
    radii = line.initial_radii_m
    rewind_m2 = radii.rewind**2 + radii.unwind**2 - unwind_m**2
    return max(radii.core, math.sqrt(max(rewind_m2, 0.0)))
