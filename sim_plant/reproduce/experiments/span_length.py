"""(3.2)-(3.22): span length, its derivative and the arm beside an eccentric roller, three ways."""

from __future__ import annotations

import numpy as np
from scipy.optimize import root

from sim_plant.base.arrays import Array
from sim_plant.geometry.shapes import circle, eccentric
from sim_plant.geometry.source_eccentric import (
    EccentricPair,
    entry_arm_m,
    span_length_m,
    span_length_rate_m_s,
)
from sim_plant.geometry.tangent import Body, Tangent, common_tangent
from sim_plant.reproduce.drawing import Panel, draw
from sim_plant.reproduce.entry import Disagreement, Experiment, Result, row_of_claim
from sim_plant.reproduce.euclid import SWRAP_RADIUS_M

D0_M, E_M, R1_M, R2_M = 0.8, 0.002, 0.0381, SWRAP_RADIUS_M
THETA = np.linspace(0.0, 2.0 * np.pi, 181)


def exact(pair: EccentricPair) -> Tangent:
    """Return the exact tangent; the pair's theta runs clockwise from the normal of the centres."""
    sigma_b = -1 if pair.over_wrap else 1
    upstream = Body(center_x_m=0.0, center_y_m=0.0, rotation=-1, shape=circle(pair.r1_m))
    roller = Body(
        center_x_m=pair.d0_m,
        center_y_m=0.0,
        rotation=sigma_b,
        shape=eccentric(pair.r2_m, pair.eccentricity_m),
    )
    # geometric centre at (d0 + e sin theta, e cos theta): global angle pi/2 - theta
    turn = sigma_b * (0.5 * np.pi - THETA)
    return common_tangent(upstream, roller, 0.0, turn, 0.0, -1.0 * sigma_b)


def brute_force_m(pair: EccentricPair, theta: float) -> float:
    """Return L by searching both contact angles: the span is normal to both radii. No formula."""
    center = complex(
        pair.d0_m + pair.eccentricity_m * np.sin(theta), pair.eccentricity_m * np.cos(theta)
    )
    side = 1.0 if pair.over_wrap else -1.0

    def miss(angles: Array) -> list[float]:
        a, b = np.exp(1j * angles[0]), side * np.exp(1j * angles[1])
        span = center + pair.r2_m * b - pair.r1_m * a
        return [float((span * np.conj(a)).real), float((span * np.conj(b)).real)]

    found = root(miss, [1.4, 1.4], tol=1e-14).x
    a, b = np.exp(1j * found[0]), side * np.exp(1j * found[1])
    return float(abs(center + pair.r2_m * b - pair.r1_m * a))


def run() -> Result:
    """Compare closed form, exact tangent and search for both ways of wrapping."""
    gaps, panels = [], []
    worst = 0.0
    for over, name in ((False, "under-wrap (3.10)"), (True, "over-wrap (3.16)")):
        pair = EccentricPair(d0_m=D0_M, eccentricity_m=E_M, r1_m=R1_M, r2_m=R2_M, over_wrap=over)
        tangent = exact(pair)
        closed = span_length_m(pair, THETA)
        searched = np.array([brute_force_m(pair, float(t)) for t in THETA])
        rate = span_length_rate_m_s(pair, THETA, 1.0)
        step = 1e-5
        numeric = np.array(
            [
                (brute_force_m(pair, float(t) + step) - brute_force_m(pair, float(t) - step))
                / 2e-5
                for t in THETA
            ]
        )
        pairs = (
            ("length", "closed form", "exact tangent", closed - tangent.length_m, "m", 1e-8),
            ("length", "closed form", "search", closed - searched, "m", 1e-8),
            (
                "derivative",
                "closed form (3.11)",
                "exact tangent",
                rate - tangent.length_rate_m_s,
                "m/rad",
                1e-8,
            ),
            (
                "derivative",
                "closed form (3.11)",
                "search, differenced",
                rate - numeric,
                "m/rad",
                1e-8,
            ),
            (
                "moment arm",
                "(3.18), (3.22)",
                "exact tangent",
                entry_arm_m(pair, THETA) - tangent.arm_b_m,
                "m",
                1e-8,
            ),
        )
        gaps += [
            Disagreement(
                what=f"{name}: {what}",
                first=a,
                second=b,
                difference=float(np.max(np.abs(d))),
                unit=u,
                limit=limit,
            )
            for what, a, b, d, u, limit in pairs
        ]
        worst = max(worst, float(np.max(np.abs(closed - searched))))
        degrees = np.degrees(THETA)
        panels.append(
            Panel(
                curves={
                    "closed form": (degrees, 1e3 * (closed - closed.mean())),
                    "search": (degrees, 1e3 * (searched - closed.mean())),
                },
                x="theta [deg]",
                y="L - mean [mm]",
                title=name,
            )
        )
    text = _angle_of_the_text()
    unsigned = _unsigned_arm_error_m()
    return Result(
        rows=(
            row_of_claim(
                "largest error of (3.10), (3.16)",
                "closed form",
                worst,
                "m",
                worst < 1e-8,
                "right as printed",
            ),
            row_of_claim(
                "over-wrap: angle ACD - BAE",
                "ACD equals BAE (text after 3.14)",
                text,
                "deg",
                abs(text) < 1e-6,
                "the triangles give ACD = ABE = 90 deg - BAE",
            ),
            row_of_claim(
                "arm error with cos(alpha) alone",
                "(3.21) suffices",
                unsigned,
                "m",
                unsigned < 1e-8,
                "sin(alpha) = -e cos(theta)/d has a sign",
            ),
        ),
        disagreements=tuple(gaps),
        figures=(draw(panels),),
    )


def _angle_of_the_text() -> float:
    """Return ACD - BAE for R1 0.2, R2 0.05, d 0.8 (3.12)-(3.14), degrees."""
    arm = 0.8 / (0.2 / 0.05 - 1.0)
    return float(np.degrees(np.arccos(0.05 / arm) - np.arcsin(0.05 / arm)))


def _unsigned_arm_error_m() -> float:
    """Return the error of the entry arm when the rotation centre has |sin(alpha)|."""
    pair = EccentricPair(d0_m=D0_M, eccentricity_m=E_M, r1_m=R1_M, r2_m=R2_M, over_wrap=False)
    mirrored = entry_arm_m(pair, np.pi - THETA)  # same d and cos(alpha), other sign of sin(alpha)
    return float(np.max(np.abs(mirrored - entry_arm_m(pair, THETA))))


EXPERIMENTS = (
    Experiment(
        identity="3.10",
        chapter=3,
        title="Span length beside an eccentric roller",
        where="(3.2)-(3.22)",
        run=run,
    ),
)
