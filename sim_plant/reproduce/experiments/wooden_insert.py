"""(4.40), Fig. 4.9 and 4.10: the wooden insert, printed and corrected, and its cubic profile."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.geometry.convex_hull import Points, shape_of_points
from sim_plant.geometry.extrema import radius_cubic
from sim_plant.geometry.roll_profiles import insert_outline
from sim_plant.reproduce.drawing import Panel, draw
from sim_plant.reproduce.entry import ClaimRow, Experiment, Result, beyond, row_of_claim
from sim_plant.reproduce.euclid import INCH_M

R_IN, FLAT_IN, THICK_IN = 5.5, 3.0, 0.5


def printed_y_in(x_in: Array) -> Array:
    """Return the upper edge of (4.40) to the letter, NaN where its root has no real value."""
    half, top = 0.5 * FLAT_IN, R_IN + THICK_IN
    shift = np.where(x_in < -half, -half, half)
    inside = 1.0 - ((x_in + shift) / (R_IN - half)) ** 2
    with np.errstate(invalid="ignore"):
        side = top * np.sqrt(inside)
    return np.asarray(np.where(np.abs(x_in) <= half, top, side))


def polar_radius_in(points: Array, angle: Array) -> Array:
    """Return r at polar angles by interpolation in an outline (rows: angles, radii)."""
    return np.asarray(np.interp(angle, points[0], points[1], period=2.0 * np.pi))


def corrected_outline_in() -> Points:
    """Return the corrected outline of (4.40) with its flat top, by angle from 0 on."""
    top = np.linspace(-0.5, 0.5, 400) * FLAT_IN + 1j * (R_IN + THICK_IN)
    outline = np.concatenate((insert_outline(R_IN, FLAT_IN, THICK_IN), top))
    return outline[np.argsort(np.mod(np.angle(outline), 2.0 * np.pi))]


def run() -> Result:
    """Draw both, find the extrema, and measure how close the cubic comes."""
    outline = corrected_outline_in()
    angles, radii = np.angle(outline), np.abs(outline)
    order = np.argsort(angles)
    polar = np.vstack((angles[order], radii[order]))
    grid = np.linspace(-np.pi, np.pi, 7201)
    radius = polar_radius_in(polar, grid)
    corner = float(np.arctan2(R_IN + THICK_IN, 0.5 * FLAT_IN))
    read = radius_maximum(grid, radius)
    by_corner, _ = cubic_through(grid, corner, float(np.hypot(6.0, 1.5)))
    cubic, extrema = cubic_through(grid, *read)
    flat = np.abs(grid - 0.5 * np.pi) < 0.5 * np.pi - corner
    misses = {
        (name, part): float(np.max(np.abs(curve - radius)[where]))
        for name, curve in (("profile", cubic), ("corner", by_corner))
        for part, where in (("flat", flat), ("sides", ~flat))
    }
    by_angle = Panel(
        curves={
            "insert": (np.degrees(grid), radius),
            "cubic (4.20), maxima of the profile": (np.degrees(grid), cubic),
            "cubic, maxima at the corners": (np.degrees(grid), by_corner),
        },
        x="angle [deg]",
        y="radius [in]",
        title="Fig. 4.10",
    )
    return Result(
        rows=_rows(misses, read, least_curvature(extrema)),
        figures=(draw([_outlines(outline), by_angle]),),
    )


def _outlines(outline: Points) -> Panel:
    """Return Fig. 4.9: the outline as printed, corrected, and what a web on it touches."""
    x = np.linspace(-R_IN, R_IN, 1201)
    hull = shape_of_points(np.asarray(outline * INCH_M, dtype=np.complex128))
    touched = hull.boundary(np.linspace(0.0, 2.0 * np.pi, 1000)) / INCH_M
    return Panel(
        curves={
            "(4.40) as printed": (x, printed_y_in(x)),
            "corrected": (outline.real, outline.imag),
            "web on it": (touched.real, touched.imag),
        },
        x="x [in]",
        y="y [in]",
        title="Fig. 4.9",
        equal=True,
    )


def _rows(
    misses: Mapping[tuple[str, str], float], read: tuple[float, float], bend: float
) -> tuple[ClaimRow, ...]:
    """Return what the source says beside what is found; ``read`` is the maximum of the radius."""
    edge = float(printed_y_in(np.array([1.5 + 1e-9]))[0])
    feature = read[1] - R_IN
    return (
        row_of_claim(
            "y at the edge of the flat by (4.40) as printed",
            "6.0 in",
            edge,
            "in",
            abs(edge - 6.0) < 1e-3,
            "the centres of the two side arcs are interchanged; "
            "at x = -r the printed root has no real value",
        ),
        *(
            row_of_claim(
                f"cubic against profile, largest error on the {part}",
                "closely approximates",
                misses["profile", part],
                "in",
                misses["profile", part] < 0.05 * feature,
                f"{100.0 * misses['profile', part] / feature:.0f} % of a feature of "
                f"{feature:.2f} in; maxima read from the profile at "
                f"{np.degrees(read[0]):.1f} deg",
            )
            for part in ("flat", "sides")
        ),
        *(
            beyond(
                f"the same with the maxima at the corners, {part}",
                misses["corner", part],
                "in",
                "the corner of the flat is no maximum of the radius: the side arc "
                "rises on beyond it",
            )
            for part in ("flat", "sides")
        ),
        row_of_claim(
            "least curvature of the cubic profile times R",
            "convex shaped roll",
            bend,
            "-",
            bend > 0.0,
            "negative curvature: no web can follow it; the hull is touched",
        ),
    )


def radius_maximum(grid: Array, radius: Array) -> tuple[float, float]:
    """Return angle and radius of the largest radius in the first quadrant, as read off a plot."""
    quarter = (grid >= 0.0) & (grid <= 0.5 * np.pi)
    k = int(np.argmax(radius[quarter]))
    return float(grid[quarter][k]), float(radius[quarter][k])


def cubic_through(
    grid: Array, angle: float, height_in: float
) -> tuple[Array, list[tuple[float, float]]]:
    """Return the profile (4.20) with its two maxima at ``angle`` and mirrored, and its extrema."""
    extrema = [
        (0.5 * np.pi, R_IN + THICK_IN),
        (angle, height_in),
        (0.0, R_IN),
        (1.5 * np.pi, R_IN),
        (np.pi, R_IN),
        (np.pi - angle, height_in),
    ]
    return radius_cubic(extrema, grid)[0], extrema


def least_curvature(extrema: list[tuple[float, float]]) -> float:
    """Return the least curvature of the cubic outline times R, from finite differences."""
    phi = np.linspace(0.0, 2.0 * np.pi, 20001)
    radius, slope = radius_cubic(extrema, phi)
    bend = np.gradient(slope, phi)
    curvature = (radius**2 + 2.0 * slope**2 - radius * bend) / (radius**2 + slope**2) ** 1.5
    return float(np.min(curvature)) * R_IN


EXPERIMENTS = (
    Experiment(
        identity="4.40",
        chapter=4,
        title="The wooden insert and its profile",
        where="(4.40), Fig. 4.9, 4.10",
        run=run,
    ),
)
