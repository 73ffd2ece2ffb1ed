"""A shape sampled for the kernel."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from aff_runtime.base.errors import PlantError
from sim_plant.geometry.shapes import Floats, Shape

DEFAULT_POINTS = 4096


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ShapeTable:
    """Deviations from the mean radius on a uniform grid of psi over one turn.

    Attributes
    ----------
    mean_radius_m : mean radius of the shape it was made from, m; the kernel may use another.
    support_m : h - R, m, n + 1 points; the last repeats the first in all three columns.
    slope_m : h', m.
    curvature_m : h + h'' - R, m.
    """

    mean_radius_m: float
    support_m: Floats
    slope_m: Floats
    curvature_m: Floats


@lru_cache(maxsize=64)
def tabulate(shape: Shape, points: int = DEFAULT_POINTS) -> ShapeTable:
    """Return the table of ``shape``; exact at the nodes (band-limited data, inverse FFT).

    Made once of a shape object; nobody writes in it.

    Raises
    ------
    PlantError
        When ``points`` is not more than twice the number of orders.
    """
    if points <= 2 * shape.deviation_m.size:
        raise PlantError(f"{points} points cannot hold {shape.deviation_m.size} orders")
    order = np.arange(1, shape.deviation_m.size + 1)
    h_n = shape.deviation_m
    return ShapeTable(
        mean_radius_m=shape.mean_radius_m,
        support_m=_samples(h_n, points),
        slope_m=_samples(1j * order * h_n, points),
        curvature_m=_samples((1.0 - order * order) * h_n, points),
    )


def _samples(coefficients: NDArray[np.complex128], points: int) -> Floats:
    """Return Re sum c_n exp(j n psi) on the grid, with the first point repeated at the end."""
    spectrum = np.zeros(points // 2 + 1, dtype=np.complex128)
    spectrum[1 : coefficients.size + 1] = 0.5 * points * coefficients
    wave = np.fft.irfft(spectrum, n=points)
    samples = np.ascontiguousarray(np.append(wave, wave[0]))
    samples.setflags(write=False)
    return samples
