"""Where each value sits in a log row of the kernel."""

from __future__ import annotations

from typing import NamedTuple

from sim_plant.base.jit import compiled


class LogLayout(NamedTuple):
    """First column of each group; one per load cell, drive, body, roll, span or carriage."""

    measured_N: int  # per load cell
    true_N: int
    mean_N: int  # mean of the tensions before and after the cell's roller
    measured_rad_s: int  # per drive
    true_rad_s: int
    theta_rad: int  # per body
    radius_m: int  # unwind, rewind
    tension_N: int  # per span
    travel_m: int  # per carriage
    encoder_rad: int  # per drive: angle of the shaft that its encoder sits on
    width: int


@compiled
def log_layout(cells: int, drives: int, bodies: int, carriages: int) -> LogLayout:
    """Return the columns of a line with so many load cells, drives, bodies and carriages."""
    speeds = 3 * cells
    angles = speeds + 2 * drives
    radii = angles + bodies
    tensions = radii + 2
    travels = tensions + bodies - 1
    encoders = travels + carriages
    return LogLayout(
        0,
        cells,
        2 * cells,
        speeds,
        speeds + drives,
        angles,
        radii,
        tensions,
        travels,
        encoders,
        encoders + drives,
    )
