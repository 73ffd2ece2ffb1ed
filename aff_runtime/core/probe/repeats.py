"""How far two probes of one operating point are apart, in the errors that they state."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from dataclasses import replace

from aff_runtime.core.response import Provenance, Response, ResponsePoint

MOST_REPEAT_ERRORS = 2.0
"""How far two probes of one operating point may be apart, in their stated errors."""
FEWEST_TONES = 8
"""Tones that two probes must share to be compared point by point."""
SAME_DIGITS = 6
"""Decimals of a frequency, Hz, by which two tones are the same one."""
TINY = 1e-12
"""Keeps two points without any stated error from dividing by nothing."""
LIKE = 0.05
"""Probes whose speed and radius differ by less, relative, are repeats: what a line wanders by."""


def same_operating_point(one: Provenance, other: Provenance) -> bool:
    """Return whether two responses were measured at one speed and one radius."""
    is_near = alike(one.line_speed_m_s, other.line_speed_m_s)
    return is_near and alike(one.radius_m, other.radius_m)


def alike(first: float, last: float) -> bool:
    """Return whether two speeds or radii count as the same; two unknown ones do."""
    if not (math.isfinite(first) and math.isfinite(last)):
        return math.isfinite(first) == math.isfinite(last)
    return abs(first - last) <= LIKE * max(abs(first), abs(last))


def repeat_sigmas(first: Response, second: Response) -> float:
    """Return how far two probes of one operating point are apart, in standard errors.

    Equation: sqrt(mean |P1 - P2|^2 / (s1^2 + s2^2)), s the standard error of each; 1 where the
    stated errors are right. It is a mean over all tones, not the worst of them: with errors that
    are right and 20 tones or more it stays below 1.3 (in 99 of 100: chi-square of two numbers per
    tone), whatever their number. 2 says that errors are stated half as large as they are.

    Tones that both have are compared. A second probe may have moved some of its tones out of the
    way of another ripple: what lies between two points of the first is known less well than its
    points, and counts only where both have too few in common.
    """
    known = {round(point.frequency_Hz, SAME_DIGITS): point for point in first.points}
    pairs = [
        (known[key], point)
        for point in second.points
        if (key := round(point.frequency_Hz, SAME_DIGITS)) in known
    ]
    if len(pairs) < FEWEST_TONES:
        pairs = list(_between(first, second))
    squares = [_square(one, other) for one, other in pairs]
    return math.sqrt(sum(squares) / len(squares)) if squares else math.nan


def _between(first: Response, second: Response) -> Iterator[tuple[ResponsePoint, ResponsePoint]]:
    """Yield the points of the second inside the band of the first, and what that has there."""
    low, high = first.band_Hz
    for point in second.points:
        if low <= point.frequency_Hz <= high:
            there = first.at(point.frequency_Hz)
            near = _nearest(first, point.frequency_Hz)
            yield replace(near, gain=abs(there), phase_rad=cmath.phase(there)), point


def _square(one: ResponsePoint, other: ResponsePoint) -> float:
    """Return the squared difference of two points in their standard errors."""
    apart = cmath.rect(one.gain, one.phase_rad) - cmath.rect(other.gain, other.phase_rad)
    errors = [point.gain * point.relative_error for point in (one, other)]
    return (abs(apart) / math.hypot(*errors, TINY)) ** 2


def _nearest(response: Response, frequency_Hz: float) -> ResponsePoint:
    return min(response.points, key=lambda point: abs(point.frequency_Hz - frequency_Hz))
