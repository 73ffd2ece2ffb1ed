"""(4.14)-(4.34): convex roll by cubics and penalty minimisation, beside the exact tangent."""

from __future__ import annotations

import timeit

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.geometry.shapes import circle, ellipse
from sim_plant.geometry.source_convex import ConvexLine, convex_span, penalised_cost, tangent_slope
from sim_plant.geometry.tangent import Body, common_tangent
from sim_plant.reproduce.drawing import Panel, draw
from sim_plant.reproduce.entry import Disagreement, Experiment, Result, beyond, row_of_claim

A_M, B_M, IDLER_M, DISTANCE_M = 0.2062, 0.2002, 0.0381, 1.2
THETA = np.linspace(0.0, 2.0 * np.pi, 61)


def polar_ellipse(phi: Array) -> tuple[Array, Array]:
    """Return r and dr/dphi of the ellipse in polar form: an outline both methods know exactly."""
    spread = (B_M * np.cos(phi)) ** 2 + (A_M * np.sin(phi)) ** 2
    radius = A_M * B_M / np.sqrt(spread)
    slope = -radius * (A_M**2 - B_M**2) * np.sin(phi) * np.cos(phi) / spread
    return radius, slope


def polar_circle(phi: Array) -> tuple[Array, Array]:
    """Return r and dr/dphi of a circle."""
    return np.full_like(phi, A_M), np.zeros_like(phi)


def run() -> Result:
    """Compare penalty minimisation and exact tangent on a circle and an ellipse; time both."""
    gaps = []
    shapes = (("circle", polar_circle, circle(A_M)), ("ellipse", polar_ellipse, ellipse(A_M, B_M)))
    for name, radius, shape in shapes:
        for over in (False, True):
            line = ConvexLine(
                radius=radius, distance_m=DISTANCE_M, idler_radius_m=IDLER_M, over_wrap=over
            )
            lengths = np.array([convex_span(line, float(t))[0].length_m for t in THETA])
            roll = Body(center_x_m=0.0, center_y_m=0.0, rotation=-1, shape=shape)
            idler = Body(
                center_x_m=DISTANCE_M,
                center_y_m=0.0,
                rotation=-1 if over else 1,
                shape=circle(IDLER_M),
            )
            exact = common_tangent(roll, idler, -THETA, 0.0).length_m
            gaps.append(
                Disagreement(
                    what=f"{name}, {'over' if over else 'under'}-wrap: length",
                    first="penalty (4.29)-(4.33)",
                    second="exact tangent",
                    difference=float(np.max(np.abs(lengths - exact))),
                    unit="m",
                    limit=1e-8,
                )
            )
    line = ConvexLine(
        radius=polar_ellipse, distance_m=DISTANCE_M, idler_radius_m=IDLER_M, over_wrap=False
    )
    each = timeit.timeit(lambda: convex_span(line, 1.0), number=10) / 10.0
    roll = Body(center_x_m=0.0, center_y_m=0.0, rotation=-1, shape=ellipse(A_M, B_M))
    idler = Body(center_x_m=DISTANCE_M, center_y_m=0.0, rotation=1, shape=circle(IDLER_M))
    many = np.linspace(0.0, 2.0 * np.pi, 2000)
    together = timeit.timeit(lambda: common_tangent(roll, idler, many, 0.0), number=3) / 6000.0
    phi = np.linspace(0.0, np.pi, 600)
    plain = np.minimum(penalised_cost(line, phi, 0.3), 0.2)
    right, printed = slopes()
    cubic_one, cubic_zero = boundary_slopes()
    panel = Panel(
        curves={"J_p, capped": (phi, plain)},
        x="phi [rad]",
        y="J_p [m2]",
        title="Fig. 4.6: one minimum left",
    )
    return Result(
        rows=(
            row_of_claim(
                "slope at the maximum with the last row of (4.17) = 1",
                "r'(1) = 0",
                cubic_one,
                "-",
                abs(cubic_one) < 1e-12,
                "the row must read 2 a2 + 3 a3 = 0; (4.18)-(4.20) "
                f"use it and give {cubic_zero:.0f}",
            ),
            row_of_claim(
                "tangent slope by (4.25) as printed",
                "m = n/d",
                printed,
                "-",
                abs(printed - right) < 1e-9,
                f"m = -d/n with + beta sin in d_0: {right:.4f}",
            ),
            row_of_claim(
                "time of one solution by penalty minimisation",
                "suits off-line tables",
                1e6 * each,
                "us",
                each < 0.05,
                "scan and bounded search",
            ),
            beyond("exact tangent, time a solution", 1e6 * together, "us", "2000 at once"),
        ),
        disagreements=tuple(gaps),
        figures=(draw([panel]),),
    )


def slopes() -> tuple[float, float]:
    """Return the slope of r = 1 + 0.3 phi + 0.1 phi^2 at 0.6 rad, right and as printed (4.25)."""
    alpha, beta, gamma, phi = 1.0, 0.3, 0.1, 0.6
    sine, cosine = np.sin(phi), np.cos(phi)
    radius, rate = alpha + beta * phi + gamma * phi**2, beta + 2.0 * gamma * phi
    n = (alpha * sine - beta * cosine) + phi * (beta * sine - 2.0 * gamma * cosine)
    n += phi**2 * gamma * sine
    d = (alpha * cosine - beta * sine) + phi * (beta * cosine + 2.0 * gamma * sine)
    d += phi**2 * gamma * cosine
    return tangent_slope(radius, rate, phi), float(n / d)


def boundary_slopes() -> tuple[float, float]:
    """Return r0'(1) for the printed and the corrected last row of (4.17)."""
    found = []
    for last in (1.0, 0.0):
        a2, a3 = np.linalg.solve(np.array([[1.0, 1.0], [2.0, 3.0]]), np.array([1.0, last]))
        found.append(float(2.0 * a2 + 3.0 * a3))
    return found[0], found[1]


EXPERIMENTS = (
    Experiment(
        identity="4.14",
        chapter=4,
        title="Span of a convex roll, penalty formulation",
        where="(4.14)-(4.34), Fig. 4.3-4.7",
        run=run,
    ),
)
