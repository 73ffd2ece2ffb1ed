"""Independent geometry for judging: taut strings round dense polygons, no support functions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim_plant.geometry.shapes import Floats

Points = NDArray[np.complex128]


def placed(outline: Points, center: complex, rotation: int, theta_rad: float) -> Points:
    """Return a body's outline in the world: turned by theta, mirrored if clockwise, shifted."""
    turned = outline * np.exp(1j * theta_rad)
    placed_points: Points = center + (turned if rotation > 0 else np.conj(turned))
    return placed_points


def polygon_tangent(
    points_a: Points, points_b: Points, rotation_a: int, rotation_b: int
) -> tuple[int, int]:
    """Return the indices of the points where a taut string leaves A and reaches B.

    From a point of one polygon the other is seen under an angle; the string goes to one edge of
    that angle: B lies left of the string if it turns counterclockwise, right if clockwise, and
    so does A. Looking back and forth until neither point moves gives open and crossed tangents.
    """
    middle_a, middle_b = complex(np.mean(points_a)), complex(np.mean(points_b))
    i, j = -1, -1
    here = middle_a
    for _ in range(100):
        next_j = _edge(points_b, here, middle_b, leftmost=rotation_b < 0)
        next_i = _edge(points_a, complex(points_b[next_j]), middle_a, leftmost=rotation_a > 0)
        if (next_i, next_j) == (i, j):
            break
        i, j = next_i, next_j
        here = complex(points_a[i])
    return i, j


def _edge(points: Points, eye: complex, middle: complex, *, leftmost: bool) -> int:
    """Return the index of the outermost point seen from ``eye``."""
    seen = (points - eye) * np.conj(middle - eye)
    tangent = seen.imag / seen.real
    return int(np.argmax(tangent) if leftmost else np.argmin(tangent))


def line_distance_m(center: complex, start: complex, end: complex) -> float:
    """Return the perpendicular distance of ``center`` from the line start-end, m."""
    along = (end - start) / abs(end - start)
    return abs(((center - start) * along.conjugate()).imag)


def taut_string(
    outlines: tuple[Points, Points],
    centers: tuple[complex, complex],
    rotations: tuple[int, int],
    theta_a_rad: Floats,
    theta_b_rad: Floats,
) -> tuple[Floats, Floats, Floats]:
    """Return span length, length delivered by A and taken up by B since the first row, m.

    ``outlines`` are body frame points, counterclockwise; arcs are sums of chords. Steps between
    rows must stay below half a turn.
    """
    arcs = [np.concatenate([[0.0], np.cumsum(np.abs(np.diff(o)))]) for o in outlines]
    perimeters = [float(s[-1] + abs(o[0] - o[-1])) for o, s in zip(outlines, arcs, strict=True)]
    rows = np.empty((theta_a_rad.size, 3))
    for k, (theta_a, theta_b) in enumerate(zip(theta_a_rad, theta_b_rad, strict=True)):
        a = placed(outlines[0], centers[0], rotations[0], float(theta_a))
        b = placed(outlines[1], centers[1], rotations[1], float(theta_b))
        i, j = polygon_tangent(a, b, *rotations)
        rows[k] = abs(b[j] - a[i]), -arcs[0][i], -arcs[1][j]
    wound = [np.unwrap(rows[:, n + 1], period=perimeters[n]) - rows[0, n + 1] for n in range(2)]
    return rows[:, 0], wound[0], wound[1]
