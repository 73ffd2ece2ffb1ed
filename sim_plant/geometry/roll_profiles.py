"""Out-of-round material rolls: flat spot, bulges, asymmetry, measured extrema, wooden insert.

Every profile is the convex hull of its outline, because a taut web touches nothing else.
Radii named ``radius_m`` are those of the round part; the shape's mean radius follows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.geometry.convex_hull import Points, shape_of_points
from sim_plant.geometry.extrema import radius_cubic
from sim_plant.geometry.shapes import Floats, Shape

POINTS = 16384
"""Of an outline, before its hull."""
BULGE_HALF_WIDTH_RAD = np.radians(30.0)
ASYMMETRIC_RISE_RAD = np.radians(45.0)
ASYMMETRIC_FALL_RAD = np.radians(30.0)


def flat_spot(depth_m: float, radius_m: float, angle_rad: float = 0.0) -> Shape:
    """Return a round roll cut by a chord ``depth_m`` below its surface, centred at ``angle_rad``.

    Raises
    ------
    PlantError
        When the depth is not within 0..radius_m.
    """
    if not 0.0 <= depth_m < radius_m:
        raise PlantError(f"flat spot depth must be within 0..{radius_m} m, got {depth_m} m")
    half_angle = np.arccos(1.0 - depth_m / radius_m)
    round_part = np.linspace(half_angle, 2.0 * np.pi - half_angle, POINTS)
    outline = (radius_m * np.exp(1j * round_part)).astype(np.complex128)
    return shape_of_points(outline).turned(angle_rad)


def bulge(
    height_m: float,
    radius_m: float,
    angle_rad: float = 0.0,
    half_width_rad: float = BULGE_HALF_WIDTH_RAD,
) -> Shape:
    """Return a round roll with one smooth bulge (cubic 4.20 up and down) at ``angle_rad``."""
    return _bump(height_m, radius_m, half_width_rad, half_width_rad).turned(angle_rad)


def asymmetric(
    size_m: float,
    radius_m: float,
    angle_rad: float = 0.0,
    rise_rad: float = ASYMMETRIC_RISE_RAD,
    fall_rad: float = ASYMMETRIC_FALL_RAD,
) -> Shape:
    """Return a round roll with a bulge of two unlike flanks: all orders with unlike phases."""
    return _bump(size_m, radius_m, rise_rad, fall_rad).turned(angle_rad)


def flattened_bulge(
    height_m: float, flat_width_m: float, radius_m: float, angle_rad: float = 0.0
) -> Shape:
    """Return a round roll with a bulge pressed flat to an edge of ``flat_width_m``."""
    edge = radius_m + height_m + 1j * np.array([-0.5, 0.5]) * flat_width_m
    return shape_of_points(np.concatenate([radius_m * _circle_points(), edge])).turned(angle_rad)


def from_extrema(extrema: Sequence[tuple[float, float]]) -> Shape:
    """Return the convex roll through measured extrema (angle_rad, radius_m) (source 4.14-4.20).

    Correction: the source's cubic between extrema is not convex on a flat spot (its own insert
    has a curvature of -2.08 / R); the web touches the convex hull of it.

    Raises
    ------
    PlantError
        When there are fewer than two extrema, or angles repeat, or a radius is not positive.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, POINTS, endpoint=False)
    radius, _ = radius_cubic(extrema, angles)
    return shape_of_points(radius * np.exp(1j * angles))


def wooden_insert(
    inner_radius_m: float, flat_length_m: float, thickness_m: float, roll_mean_radius_m: float
) -> Shape:
    """Return web wound on the source's wooden insert (4.40 corrected), flat at psi = 0.

    Correction: (4.40) has the centres of the two side arcs swapped; as printed the edge of the
    flat lies at 3.97 in instead of 6.0 in and x = -r has no real y. Winding adds a parallel curve.

    Raises
    ------
    PlantError
        When the roll is smaller than the bare insert.
    """
    bare = shape_of_points(insert_outline(inner_radius_m, flat_length_m, thickness_m))
    if roll_mean_radius_m < bare.mean_radius_m:
        raise PlantError(
            f"roll of mean radius {roll_mean_radius_m} m is smaller than its insert "
            f"({bare.mean_radius_m:.6g} m)"
        )
    return bare.at_radius(roll_mean_radius_m).turned(-0.5 * np.pi)


def insert_outline(inner_radius_m: float, flat_length_m: float, thickness_m: float) -> Points:
    """Return the outline of the wooden insert, x + j y, ccw, flat side up (4.40 corrected)."""
    half_flat = 0.5 * flat_length_m
    top = inner_radius_m + thickness_m
    side = np.linspace(0.0, 0.5 * np.pi, POINTS // 4)
    x_side = (inner_radius_m - half_flat) * np.cos(side)
    right = half_flat + x_side + 1j * top * np.sin(side)
    left = -half_flat - x_side + 1j * top * np.sin(side)
    below = inner_radius_m * np.exp(1j * np.linspace(np.pi, 2.0 * np.pi, POINTS // 2))
    return np.concatenate([right, left[::-1], below])


def _bump(height_m: float, radius_m: float, rise_rad: float, fall_rad: float) -> Shape:
    """Return a round roll whose radius rises by ``height_m`` to angle 0 and falls again."""
    angles = np.linspace(-np.pi, np.pi, POINTS, endpoint=False)
    inside = np.where(angles < 0.0, 1.0 + angles / rise_rad, 1.0 - angles / fall_rad)
    share: Floats = np.clip(inside, 0.0, 1.0)
    radius = radius_m + height_m * share * share * (3.0 - 2.0 * share)
    return shape_of_points(radius * np.exp(1j * angles))


def _circle_points() -> Points:
    """Return dense points of the unit circle."""
    points: Points = np.exp(2j * np.pi * np.arange(POINTS) / POINTS)
    return points
