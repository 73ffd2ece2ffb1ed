"""Span cases that several tests share."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from sim_plant.geometry.roll_profiles import flat_spot
from sim_plant.geometry.shapes import Floats, Shape, circle, eccentric, ellipse
from sim_plant.geometry.tangent import Body, Tangent, common_tangent

POINTS = 4096
TAU = 2.0 * np.pi * np.arange(POINTS) / POINTS
R_UNWIND = 8.0 * 0.0254
R_IDLER = 1.5 * 0.0254
R_SWRAP = 6.05 * 0.0254


@dataclass(frozen=True)
class Pair:
    """Two bodies; B turns ``turns_b`` times (a whole number) while A turns once."""

    a: Body
    b: Body
    turns_b: int

    @cache  # noqa: B019  (pairs stay as long as the tests that share them)
    def over_one_turn(self) -> Tangent:
        """Return the span at each point of a turn; who asks only reads."""
        return common_tangent(self.a, self.b, TAU, self.turns_b * TAU, 1.0, float(self.turns_b))


def pair_of_length(
    shape_a: Shape, shape_b: Shape, length_m: float, sigma: tuple[int, int], turns_b: int
) -> Pair:
    """Return a pair whose span has ``length_m`` for the mean radii, on a slanted centre line."""
    across = sigma[0] * shape_a.mean_radius_m - sigma[1] * shape_b.mean_radius_m
    distance, slant = np.hypot(length_m, across), 0.4
    a = Body(center_x_m=0.3, center_y_m=-0.1, rotation=sigma[0], shape=shape_a)
    b = Body(
        center_x_m=0.3 + distance * np.cos(slant),
        center_y_m=-0.1 + distance * np.sin(slant),
        rotation=sigma[1],
        shape=shape_b,
    )
    return Pair(a, b, turns_b)


FLAT = flat_spot(0.012, R_UNWIND)
PAIRS = {
    "flat spot": pair_of_length(FLAT, circle(R_IDLER), 1.2, (1, -1), 5),
    "flat spot, short, same side": pair_of_length(FLAT, circle(R_IDLER), 0.4, (-1, -1), 5),
    "ellipse": pair_of_length(ellipse(0.2062, 0.2002), circle(R_IDLER), 0.9, (1, 1), 5),
    "eccentric": pair_of_length(eccentric(R_SWRAP, 5e-4, 0.3), circle(R_IDLER), 0.9, (-1, 1), 4),
    "crossed S-wrap": pair_of_length(
        eccentric(R_SWRAP, 5e-4, 0.3), eccentric(R_SWRAP, 4e-4, -1.0), 0.12, (1, -1), 1
    ),
    "ellipse onto ellipse": pair_of_length(
        ellipse(0.2062, 0.2002), ellipse(0.1, 0.102), 0.5, (-1, 1), 2
    ),
}


def derivative(wave: Floats) -> Floats:
    """Return d/dtau of one period of samples."""
    order = np.arange(POINTS // 2 + 1)
    slope: Floats = np.fft.irfft(1j * order * np.fft.rfft(wave), POINTS)
    return slope


def integral(wave: Floats) -> Floats:
    """Return the integral over tau from 0 of one period of samples."""
    spectrum = np.fft.rfft(wave)
    mean = spectrum[0].real / POINTS
    order = np.arange(POINTS // 2 + 1)
    order[0] = 1
    spectrum = spectrum / (1j * order)
    spectrum[0] = 0.0
    periodic = np.fft.irfft(spectrum, POINTS)
    total: Floats = mean * TAU + periodic - periodic[0]
    return total


def harmonic(wave: Floats, order: int) -> float:
    """Return the amplitude of one order of one period of samples."""
    return float(2.0 * abs(np.fft.rfft(wave)[order]) / POINTS)
