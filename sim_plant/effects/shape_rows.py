"""Attach a shape to a body: one table row per shaped body, deviations add."""

from __future__ import annotations

import numpy as np

from sim_plant.base.arrays import LineArrays
from sim_plant.geometry.shapes import Shape
from sim_plant.geometry.table import DEFAULT_POINTS, tabulate


def add_shape(arrays: LineArrays, body: int, shape: Shape) -> LineArrays:
    """Return arrays in which ``body`` has the deviations of ``shape`` on top of its own.

    The body's radius (the declared one, which its drive and its radius sensor go by) stays what
    it was; a shape whose mean radius is another, as a cut roll's is, brings the difference along
    as a constant of h, so the roll turns faster or slower than its radius tells.
    """
    table = tabulate(shape)
    offset_m = shape.mean_radius_m - float(arrays.bodies["radius_m"][body])
    if not np.any(shape.deviation_m) and offset_m == 0.0:
        return arrays
    columns = (table.support_m + offset_m, table.slope_m, table.curvature_m + offset_m)
    stacks = (arrays.shape_h_m, arrays.shape_dh_m, arrays.shape_rho_m)
    row = int(arrays.bodies["shape_row"][body])
    used = int(np.max(arrays.bodies["shape_row"])) + 1
    grown = []
    for stack, column in zip(stacks, columns, strict=True):
        kept = stack if used else np.zeros((0, column.size))
        if row >= 0:
            kept = kept.copy()
            kept[row] += column
        else:
            kept = np.vstack([kept, column[None, :]])
        grown.append(np.ascontiguousarray(kept))
    if row < 0:
        arrays.bodies["shape_row"][body] = used
    return arrays._replace(shape_h_m=grown[0], shape_dh_m=grown[1], shape_rho_m=grown[2])


def add_mean(arrays: LineArrays, body: int, mean_m: float) -> LineArrays:
    """Return arrays in which the web feels ``body`` larger by ``mean_m`` all round.

    Drive and radius sensor keep the declared radius: a profile whose perimeter is not 2 pi times
    the radius it is declared with (a flat spot of 12 mm on 8 in: -0.22 %) turns at another speed.
    """
    if mean_m == 0.0:
        return arrays
    row = int(arrays.bodies["shape_row"][body])
    columns = arrays.shape_h_m.shape[1]
    grown = [arrays.shape_h_m, arrays.shape_dh_m, arrays.shape_rho_m]
    if row < 0:
        used = int(np.max(arrays.bodies["shape_row"])) + 1
        columns = columns if used else DEFAULT_POINTS + 1
        grown = [np.resize(s[:used], (used, columns)) for s in grown]
        grown = [np.vstack([s, np.zeros((1, columns))]) for s in grown]
        arrays.bodies["shape_row"][body] = row = used
    grown = [s.copy() for s in grown]
    grown[0][row] += mean_m
    grown[2][row] += mean_m
    return arrays._replace(shape_h_m=grown[0], shape_dh_m=grown[1], shape_rho_m=grown[2])


def add_gravity_moment(
    arrays: LineArrays, body: int, gravity_moment_N_m: float, angle_rad: float
) -> None:
    """Add a gravity imbalance m g e at a body angle, as a phasor, to the body's own."""
    record = arrays.bodies[body : body + 1]
    old = record["gravity_moment_N_m"][0] * np.exp(1j * record["gravity_moment_angle_rad"][0])
    new = old + gravity_moment_N_m * np.exp(1j * angle_rad)
    record["gravity_moment_N_m"] = abs(new)
    record["gravity_moment_angle_rad"] = np.angle(new)
