import numpy as np
import pytest

from sim_plant.geometry import source_eccentric as source
from sim_plant.geometry.shapes import circle, eccentric
from sim_plant.geometry.source_eccentric import EccentricPair
from sim_plant.geometry.tangent import Body, Tangent, common_tangent
from tests.each_case import each_case

THETA = np.linspace(0.0, 2.0 * np.pi, 97)
PAIRS = [
    EccentricPair(d0_m=0.8, eccentricity_m=0.002, r1_m=0.2, r2_m=0.15, over_wrap=over)
    for over in (True, False)
] + [
    EccentricPair(d0_m=0.5, eccentricity_m=0.002, r1_m=r1, r2_m=0.15, over_wrap=True)
    for r1 in (0.15, 0.04)
]


def exact(pair: EccentricPair) -> Tangent:
    """Return the exact tangent; C's geometric centre stands at pi/2 - theta, web on B's top."""
    sigma = -1 if pair.over_wrap else 1
    a = Body(center_x_m=0.0, center_y_m=0.0, rotation=-1, shape=circle(pair.r1_m))
    shape = eccentric(pair.r2_m, pair.eccentricity_m)
    b = Body(center_x_m=pair.d0_m, center_y_m=0.0, rotation=sigma, shape=shape)
    return common_tangent(a, b, 0.0, sigma * (0.5 * np.pi - THETA), 0.0, -3.0 * sigma)


@each_case("pair", PAIRS)
def test_closed_forms_agree_with_the_exact_tangent(pair: EccentricPair) -> None:
    span = exact(pair)
    assert source.span_length_m(pair, THETA) == pytest.approx(span.length_m, abs=1e-12)
    assert source.span_length_rate_m_s(pair, THETA, 3.0) == pytest.approx(
        span.length_rate_m_s, abs=1e-12
    )
    assert source.entry_arm_m(pair, THETA) == pytest.approx(span.arm_b_m, abs=1e-12)


def test_unsigned_alpha_spoils_the_arm_by_millimetres() -> None:
    pair = EccentricPair(d0_m=0.8, eccentricity_m=0.002, r1_m=0.2, r2_m=0.15, over_wrap=False)
    x, y = source.entry_point_m(pair, THETA)
    x_r, y_r = source.rotation_center_m(pair, THETA)
    d_en = np.hypot(x - x_r, y - np.abs(y_r))
    unsigned = (0.15**2 + d_en**2 - 0.002**2) / (2.0 * 0.15)
    worst = np.max(np.abs(unsigned - source.entry_arm_m(pair, THETA)))
    assert 1e-3 < worst < 4e-3


def test_over_wrap_angle_is_the_complement_of_the_printed_one() -> None:
    # R1 = 0.2, R2 = 0.05, d = 0.8: 79.19 degrees, BAE = 10.81 (physics.md)
    pair = EccentricPair(d0_m=0.8, eccentricity_m=0.0, r1_m=0.2, r2_m=0.05, over_wrap=True)
    assert np.degrees(source.contact_angle_rad(pair, 0.0)) == pytest.approx(79.19, abs=0.005)
