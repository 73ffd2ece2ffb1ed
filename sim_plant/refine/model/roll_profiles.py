"""From the orders of an out-of-round roll to the named profile that has them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.effects.out_of_round_roll import KINDS, named
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.hypotheses import Hypothesis, hypothesis

SIZES_M = (0.001, 0.002, 0.004, 0.006, 0.009, 0.012, 0.016)
PROFILE_NUMBERS = ("size_m", "angle_rad", "smoothing_rad")
FLATTENED = "flattened_bulge"
EFFECT = "out_of_round_roll"
UNWOUND = "unwound_m"


def profile_starts(
    location: str,
    radius_m: float,
    inner: Array,
    against: Array,
    amplitudes_m: Sequence[float],
    keep: int = 2,
) -> list[tuple[Hypothesis, tuple[float, ...]]]:
    """Return named profiles with size and angle that explain most, best first.

    ``inner`` (2 n, 2 n) and ``against`` (2 n,) are S'PS and S'Pr of the order columns
    (cos, sin per order, columns per ``amplitudes_m``): a profile is a fixed mix of orders, so its
    gain 2 z'b - z'Gz needs no simulation.
    """
    orders = len(amplitudes_m) // 2
    angles = np.radians(np.arange(0.0, 360.0, 2.0))
    number = np.arange(1, orders + 1)
    found: list[tuple[float, str, float, float]] = []
    for kind in KINDS:
        if kind == "orders":
            continue
        best = (-np.inf, kind, 0.0, 0.0)
        for size in SIZES_M:
            shape = named(kind, size, radius_m, 0.0).deviation_m
            h = np.zeros(orders, dtype=np.complex128)
            h[: min(orders, shape.size)] = shape[:orders]
            turned = h[None, :] * np.exp(-1j * np.outer(angles, number))
            z = np.stack([turned.real, -turned.imag], axis=2).reshape(angles.size, -1)
            z = z / np.asarray(amplitudes_m)
            gain = 2.0 * z @ against - np.einsum("ai,ij,aj->a", z, inner, z)
            at = int(np.argmax(gain))
            best = max(best, (float(gain[at]), kind, size, float(angles[at])))
        found.append(best)
    found.sort(reverse=True)
    return [
        _start(location, kind, size, angle)
        for gain, kind, size, angle in found[:keep]
        if gain > 0.0
    ]


def _start(
    location: str, kind: str, size_m: float, angle_rad: float
) -> tuple[Hypothesis, tuple[float, ...]]:
    wide = kind == FLATTENED
    names = (*PROFILE_NUMBERS, *(("flat_width_m",) if wide else ()))
    start = (size_m, angle_rad, 0.02, *((6.0 * size_m,) if wide else ()))
    choice = (("shape", kind), ("finest_order", CRITERIA.model.finest_order))
    return hypothesis(BY_NAME[EFFECT], location, choice, names), start
