import numpy as np
import pytest

from sim_plant.geometry.roll_profiles import flat_spot
from sim_plant.geometry.shapes import Floats, Shape, circle, eccentric, ellipse
from sim_plant.geometry.source_flow import arc_length_m, exit_distance_m, web_supply_m_s
from sim_plant.geometry.tangent import Tangent
from tests.sim_plant.geometry.pairs import (
    FLAT,
    PAIRS,
    R_IDLER,
    R_SWRAP,
    R_UNWIND,
    Pair,
    harmonic,
    pair_of_length,
)
from tests.sim_plant.geometry.test_source_convex import ellipse_radius

ECCENTRIC = eccentric(R_SWRAP, 5e-4)
TO_TWO_DEGREES_RAD = np.radians(np.sqrt(2.0**2 - 0.7**2))
FLAT_4_MM = flat_spot(0.004, R_UNWIND).smoothed(TO_TWO_DEGREES_RAD)


def supply(pair: Pair, span: Tangent, *, wander: bool) -> Floats:
    return web_supply_m_s(
        span.flow_a_m_s,
        span.length_rate_m_s,
        span.phi_rate_rad_s,
        pair.b.shape.mean_radius_m,
        pair.b.rotation,
        wander=wander,
    )


@pytest.mark.parametrize("sigma", [(1, -1), (1, 1), (-1, 1), (-1, -1)])
def test_with_wander_the_arc_length_flow_is_the_moment_arm(sigma: tuple[int, int]) -> None:
    for shape in (FLAT, ellipse(0.2062, 0.2002), ECCENTRIC):
        pair = pair_of_length(shape, circle(R_IDLER), 0.4, sigma, 5)
        span = pair.over_one_turn()
        error = supply(pair, span, wander=True) - span.arm_a_m
        assert np.max(np.abs(error)) < 1e-6 * np.ptp(span.arm_a_m)


@pytest.mark.parametrize(
    ("pair", "percents"),
    [
        (pair_of_length(FLAT, circle(R_IDLER), 1.2, (1, -1), 1), (3.2, 6.3, 9.5, 12.7)),
        (pair_of_length(FLAT, circle(R_IDLER), 0.4, (1, -1), 1), (9.5, 19.0, 28.5, 38.0)),
        (pair_of_length(ECCENTRIC, circle(R_IDLER), 0.9, (1, -1), 1), (4.2,)),
        (pair_of_length(ECCENTRIC, circle(R_SWRAP), 0.12, (1, -1), 1), (128.0,)),
        (pair_of_length(ECCENTRIC, circle(R_SWRAP), 0.30, (1, -1), 1), (51.0,)),
    ],
    ids=["flat 1.2 m", "flat 0.4 m", "eccentric", "S-wrap 0.12 m", "S-wrap 0.30 m"],
)
def test_without_wander_each_harmonic_errs_by_n_radius_over_length(
    pair: Pair, percents: tuple[float, ...]
) -> None:
    # physics.md, table of (4.46)
    span = pair.over_one_turn()
    error = supply(pair, span, wander=False) - span.arm_a_m
    for n, percent in enumerate(percents, start=1):
        found = 100.0 * harmonic(error, n) / harmonic(span.arm_a_m, n)
        assert found == pytest.approx(percent, rel=0.012)


def test_arc_length_in_polar_form_closes_to_the_perimeter() -> None:
    whole = arc_length_m(ellipse_radius, 0.3, 0.3 + 2.0 * np.pi)
    assert whole == pytest.approx(ellipse(0.206, 0.2).perimeter_m, abs=1e-12)


def test_arc_length_between_contacts_is_the_web_delivered() -> None:
    pair = PAIRS["ellipse"]
    span = pair.over_one_turn()
    axes = [float(pair.a.shape.evaluate(psi)[0]) for psi in (0.0, 0.5 * np.pi)]

    def radius(phi: Floats) -> tuple[Floats, Floats]:
        a, b = axes
        square = (b * np.cos(phi)) ** 2 + (a * np.sin(phi)) ** 2
        slope = -a * b * (a * a - b * b) * np.sin(phi) * np.cos(phi) / square**1.5
        return a * b / np.sqrt(square), slope

    contact = np.unwrap(np.angle(pair.a.shape.boundary(span.psi_a_rad)))
    delivered = arc_length_m(radius, float(contact[1024]), float(contact[0]))
    flow = span.flow_a_m_s
    step = 2.0 * np.pi / flow.size
    simpson = (
        step / 3.0 * (flow[0] + flow[1024] + 4 * flow[1:1024:2].sum() + 2 * flow[2:1024:2].sum())
    )
    assert delivered == pytest.approx(simpson, abs=1e-11)


@pytest.mark.parametrize(
    ("shape", "worst_m"),
    [(FLAT.smoothed(TO_TWO_DEGREES_RAD), 6.8e-3), (ellipse(0.2062, 0.2002), 0.09e-3)],
    ids=["flat 12 mm", "ellipse"],
)
def test_distance_to_the_exit_point_is_not_the_torque_arm(shape: Shape, worst_m: float) -> None:
    # physics.md, row 4.37
    span = pair_of_length(shape, circle(R_IDLER), 1.2, (1, -1), 1).over_one_turn()
    _, slope, _ = shape.evaluate(span.psi_a_rad)
    error = exit_distance_m(span.arm_a_m, slope) - span.arm_a_m
    assert np.max(error) == pytest.approx(worst_m, rel=0.02)


@pytest.mark.parametrize(
    ("shape", "radius_b_m", "length_m", "percent"),
    [
        (FLAT_4_MM, R_IDLER, 1.2, 32.0),
        (FLAT_4_MM, R_IDLER, 0.4, 96.0),
        (FLAT_4_MM, 6.0 * 0.0254, 0.4, 386.0),
        (ellipse(0.2062, 0.2002), R_IDLER, 1.2, 6.4),
    ],
)
def test_without_wander_the_whole_oscillation_errs_as_measured(
    shape: Shape, radius_b_m: float, length_m: float, percent: float
) -> None:
    # physics.md, below the table of (4.46); corners rounded by 2 degrees
    pair = pair_of_length(shape, circle(radius_b_m), length_m, (1, -1), 1)
    span = pair.over_one_turn()
    error = supply(pair, span, wander=False) - span.arm_a_m
    assert 100.0 * np.std(error) / np.std(span.arm_a_m) == pytest.approx(percent, rel=0.02)
