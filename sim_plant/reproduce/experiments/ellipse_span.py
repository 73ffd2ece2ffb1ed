"""(4.1)-(4.13): span of an elliptical roll by Algorithms 1 and 2, beside the exact tangent."""

from __future__ import annotations

import math
import timeit

import numpy as np
from scipy.optimize import root

from sim_plant.base.arrays import Array
from sim_plant.geometry.shapes import circle, ellipse
from sim_plant.geometry.source_ellipse import EllipseLine, ellipse_span, signed_distance_m
from sim_plant.geometry.tangent import Body, common_tangent
from sim_plant.reproduce.drawing import Panel, draw
from sim_plant.reproduce.entry import Disagreement, Experiment, Result, beyond, row_of_claim

A_M, B_M, IDLER_M, X_M, Y_M = 0.2062, 0.2002, 0.0381, 1.2, -0.2
THETA = np.linspace(0.0, 2.0 * np.pi, 73)


def line_of(over_wrap: bool) -> EllipseLine:
    """Return the roll of the example with its idler."""
    return EllipseLine(
        a_m=A_M,
        b_m=B_M,
        idler_x_m=X_M,
        idler_y_m=Y_M,
        idler_radius_m=IDLER_M,
        upper=True,
        over_wrap=over_wrap,
    )


def exact_lengths(over_wrap: bool, theta: Array) -> Array:
    """Return lengths by the exact tangent; a web leaving on top turns the roll clockwise."""
    roll = Body(center_x_m=0.0, center_y_m=0.0, rotation=-1, shape=ellipse(A_M, B_M))
    idler = Body(
        center_x_m=X_M, center_y_m=Y_M, rotation=-1 if over_wrap else 1, shape=circle(IDLER_M)
    )
    return common_tangent(roll, idler, -theta, 0.0).length_m


def searched_length(over_wrap: bool, theta: float) -> float:
    """Return the length by searching contact parameter and contact angle, no tangent formula."""
    turn, side = np.exp(1j * theta), 1.0 if over_wrap else -1.0
    center = complex(X_M, Y_M)
    start = ellipse_span(line_of(over_wrap), theta)
    near = start.roll / turn

    def miss(x: Array) -> list[float]:
        point = complex(A_M * np.cos(x[0]), B_M * np.sin(x[0])) * turn
        along = complex(-A_M * np.sin(x[0]), B_M * np.cos(x[0])) * turn
        ray = side * np.exp(1j * x[1])
        span = center + IDLER_M * ray - point
        return [float((span * np.conj(1j * along)).real), float((span * np.conj(ray)).real)]

    guess = [
        math.atan2(near.imag / B_M, near.real / A_M) + 0.02,
        float(np.angle(side * (start.idler - center))) + 0.02,
    ]
    x = root(miss, guess, tol=1e-14).x
    point = complex(A_M * np.cos(x[0]), B_M * np.sin(x[0])) * turn
    return float(abs(center + side * IDLER_M * np.exp(1j * x[1]) - point))


def run() -> Result:
    """Compare minimisation, exact tangent and search, and time the first two."""
    gaps, panels = [], []
    for over, name in ((False, "under-wrap"), (True, "over-wrap")):
        line = line_of(over)
        minimised = np.array([ellipse_span(line, float(t)).length_m for t in THETA])
        exact = exact_lengths(over, THETA)
        searched = np.array([searched_length(over, float(t)) for t in THETA])
        gaps += [
            Disagreement(
                what=f"{name}: length",
                first="Algorithms 1, 2",
                second=second,
                difference=float(np.max(np.abs(minimised - other))),
                unit="m",
                limit=1e-8,
            )
            for second, other in (("exact tangent", exact), ("search", searched))
        ]
        panels.append(
            Panel(
                curves={
                    "Algorithms 1, 2": (THETA, 1e3 * minimised),
                    "exact tangent": (THETA, 1e3 * exact),
                },
                x="theta [rad]",
                y="L [mm]",
                title=name,
            )
        )
    each = timeit.timeit(lambda: ellipse_span(line_of(False), 1.0), number=20) / 20.0
    many = np.linspace(0.0, 2.0 * np.pi, 2000)
    together = timeit.timeit(lambda: exact_lengths(False, many), number=3) / 3.0 / many.size
    right, printed, slope_gap = printed_formulas()
    return Result(
        rows=(
            row_of_claim(
                "distance of (0.2, 0.5) from a tangent, (4.3) as printed",
                "(4.3), (4.5)",
                printed,
                "m",
                abs(printed - right) < 1e-9,
                f"the root covers the denominator only: {right:.4f} m",
            ),
            row_of_claim(
                "tangent angle atan2(beta, -alpha) of Algorithm 1, error",
                "Algorithm 1",
                slope_gap,
                "deg",
                abs(slope_gap) < 1e-6,
                "atan2(-alpha, beta) is right",
            ),
            row_of_claim(
                "time of one solution by minimisation",
                "efficient",
                1e6 * each,
                "us",
                each < 5e-3,
                "fast enough off line",
            ),
            beyond(
                "exact tangent, time a solution",
                1e6 * together,
                "us",
                "whole tables at once; Newton on dF/dphi = L",
                claim="none in closed form",
            ),
        ),
        disagreements=tuple(gaps),
        figures=(draw(panels),),
    )


def printed_formulas() -> tuple[float, float, float]:
    """Return distance right and as printed (4.5), and the error of the printed tangent angle."""
    line, phi, point = line_of(False), 1.2, complex(0.2, 0.5)
    right = abs(signed_distance_m(line, phi, point))
    alpha, beta = math.cos(phi) / A_M, math.sin(phi) / B_M
    top = abs(alpha * point.real + beta * point.imag - 1.0)
    printed = math.sqrt(top / (alpha * alpha + beta * beta))
    gap = math.degrees(math.atan2(beta, -alpha) - math.atan2(-alpha, beta)) % 180.0
    return right, printed, gap


EXPERIMENTS = (
    Experiment(
        identity="4.1",
        chapter=4,
        title="Span of an elliptical roll",
        where="(4.1)-(4.13), Algorithms 1 and 2",
        run=run,
    ),
)
