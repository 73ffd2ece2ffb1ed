"""The source's profile from measured extrema: one cubic between neighbours (4.14-4.20)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from aff_runtime.base.errors import PlantError
from sim_plant.geometry.shapes import Floats


def radius_cubic(
    extrema: Sequence[tuple[float, float]], angle_rad: ArrayLike
) -> tuple[Floats, Floats]:
    """Return radius, m, and its derivative, m/rad, at polar angles ``angle_rad`` (source 4.20).

    Between neighbouring extrema r = r_a + (r_b - r_a)(3 u^2 - 2 u^3), u the share of the gap.
    Corrections: (4.14) names r_1 twice; the last row of (4.17) must read 2 a_2 + 3 a_3 = 0 (the
    printed 1 gives -u^3 + 2 u^2, whose slope does not vanish at the maximum); (4.18)-(4.20)
    already use the right one.

    Parameters
    ----------
    extrema : (angle_rad, radius_m) of every radius maximum and minimum, any order, one turn.

    Raises
    ------
    PlantError
        When there are fewer than two extrema, or angles repeat, or a radius is not positive.
    """
    nodes = np.array(
        [(angle % (2.0 * np.pi), radius) for angle, radius in sorted_by_turn(extrema)]
    )
    start, radii = nodes[:, 0], nodes[:, 1]
    gap = np.diff(start, append=start[0] + 2.0 * np.pi)
    rise = np.roll(radii, -1) - radii
    turn = np.mod(np.asarray(angle_rad, dtype=np.float64) - start[0], 2.0 * np.pi)
    index = np.clip(np.searchsorted(start - start[0], turn, side="right") - 1, 0, start.size - 1)
    share = (turn - (start[index] - start[0])) / gap[index]
    radius = radii[index] + rise[index] * share * share * (3.0 - 2.0 * share)
    return radius, rise[index] * 6.0 * share * (1.0 - share) / gap[index]


def sorted_by_turn(extrema: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the extrema by angle within one turn, checked."""
    rows = sorted((angle % (2.0 * np.pi), radius) for angle, radius in extrema)
    if len(rows) < 2:
        raise PlantError(f"a profile needs at least two radius extrema, got {len(rows)}")
    if any(radius <= 0.0 for _, radius in rows):
        raise PlantError("radius extrema must be positive")
    if any(b[0] - a[0] < 1e-9 for a, b in pairwise(rows)):
        raise PlantError("two radius extrema stand at the same angle")
    return rows
