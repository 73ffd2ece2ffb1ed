import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from aff_runtime.base.errors import PlantError
from sim_plant.geometry.shapes import Shape, circle, eccentric, ellipse, orders
from sim_plant.geometry.tangent import Body, common_tangent
from tests.sim_plant.geometry.brute_force import line_distance_m, placed, taut_string
from tests.sim_plant.geometry.pairs import PAIRS, POINTS, TAU, Pair, derivative, integral

DENSE = np.linspace(0.0, 2.0 * np.pi, 1 << 17, endpoint=False)
IDENTITY_TOLERANCE = 1e-6


@pytest.mark.parametrize("name", PAIRS)
def test_span_identity_holds_by_numerical_differentiation(name: str) -> None:
    # dL/dt + ldot_B - ldot_A = p_B w_B - p_A w_A, left side from L and arc length alone
    pair = PAIRS[name]
    span = pair.over_one_turn()
    left = (
        derivative(span.length_m)
        + _flow(pair.b.shape, span.psi_b_rad, pair.turns_b)
        - _flow(pair.a.shape, span.psi_a_rad, 1)
    )
    right = span.arm_b_m * pair.turns_b - span.arm_a_m
    assert np.max(np.abs(left - right)) < IDENTITY_TOLERANCE * np.ptp(right)


def _flow(shape: Shape, psi_rad: NDArray[np.float64], turns: int) -> NDArray[np.float64]:
    """Return the rate of web length over the contact point, from arc length S(psi)."""
    n = np.arange(1, shape.deviation_m.size + 1)
    arc_n = (1.0 - n * n) * shape.deviation_m / (1j * n)
    wave = Shape(mean_radius_m=1.0, deviation_m=arc_n).evaluate(psi_rad)[0] - 1.0
    drift = psi_rad + turns * TAU  # periodic
    return shape.mean_radius_m * (turns - derivative(drift)) - derivative(wave)


def _outline(shape: Shape, name: str) -> NDArray[np.complex128]:
    """Return a dense outline; ellipses and circles from their own parametric equations."""
    if name.startswith("ellipse"):
        half = abs(shape.evaluate(0.0)[0]), abs(shape.evaluate(0.5 * np.pi)[0])
        return half[0] * np.cos(DENSE) + 1j * half[1] * np.sin(DENSE)
    if shape.deviation_m.size <= 1:
        shift = np.conj(shape.deviation_m[0]) if shape.deviation_m.size else 0.0
        return shift + shape.mean_radius_m * np.exp(1j * DENSE)
    return shape.boundary(DENSE)


@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.sweep(every=3)
def test_span_identity_holds_for_a_taut_string_round_polygons(name: str) -> None:
    pair = PAIRS[name]
    span = pair.over_one_turn()
    rows = np.arange(0, POINTS, POINTS // (8 * pair.turns_b))[: 4 * pair.turns_b]
    length, given_out, taken_up = taut_string(
        (_outline(pair.a.shape, name), _outline(pair.b.shape, name)),
        (_center(pair.a), _center(pair.b)),
        (pair.a.rotation, pair.b.rotation),
        TAU[rows],
        pair.turns_b * TAU[rows],
    )
    imposed = span.arm_b_m * pair.turns_b - span.arm_a_m
    stretched = integral(imposed)
    oscillation = np.ptp(stretched - np.mean(imposed) * TAU)
    found = length - length[0] + taken_up - given_out
    assert np.max(np.abs(found - stretched[rows])) < IDENTITY_TOLERANCE * oscillation
    assert length == pytest.approx(span.length_m[rows], abs=2e-4)  # polygon's contact is coarse


def _center(body: Body) -> complex:
    return complex(body.center_x_m, body.center_y_m)


@pytest.mark.parametrize("name", PAIRS)
def test_line_touches_both_bodies_and_arm_is_its_distance_from_the_axis(name: str) -> None:
    pair = PAIRS[name]
    span = pair.over_one_turn()
    for k in (0, 517, 1900, 3333):
        ends, distances = [], []
        for body, psi, theta in (
            (pair.a, span.psi_a_rad[k], TAU[k]),
            (pair.b, span.psi_b_rad[k], pair.turns_b * TAU[k]),
        ):
            touch = body.shape.boundary(np.array([psi]))
            ends.append(complex(placed(touch, _center(body), body.rotation, theta)[0]))
        distances = [line_distance_m(_center(body), *ends) for body in (pair.a, pair.b)]
        assert distances == pytest.approx([span.arm_a_m[k], span.arm_b_m[k]], abs=1e-13)
        assert abs(ends[1] - ends[0]) == pytest.approx(span.length_m[k], abs=1e-13)
        assert np.angle(ends[1] - ends[0]) == pytest.approx(span.phi_rad[k], abs=1e-12)


@pytest.mark.parametrize("name", PAIRS)
def test_rates_are_the_derivatives_of_angle_and_length(name: str) -> None:
    span = PAIRS[name].over_one_turn()
    for rate, wave in ((span.phi_rate_rad_s, span.phi_rad), (span.length_rate_m_s, span.length_m)):
        assert np.max(np.abs(rate - derivative(wave))) < 1e-7 * np.ptp(rate)


@pytest.mark.parametrize("name", PAIRS)
def test_moment_arm_is_the_torque_arm_by_virtual_work(name: str) -> None:
    # turn A alone with the web held on B and no web leaving A: the string must give way by p
    pair = PAIRS[name]
    step = 1e-5
    theta = np.array([0.9 - step, 0.9, 0.9 + step])
    span = common_tangent(pair.a, pair.b, theta, 0.2)
    arc_a = _arc(pair.a.shape, span.psi_a_rad)
    arc_b = _arc(pair.b.shape, span.psi_b_rad)
    string = span.length_m + arc_a - arc_b
    arm = -(string[2] - string[0]) / (2.0 * step)
    assert arm == pytest.approx(span.arm_a_m[1], abs=1e-8)


def _arc(shape: Shape, psi_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return arc length from psi = psi_rad[1], by Gauss-Legendre on h + h''."""
    node, weight = np.polynomial.legendre.leggauss(8)
    middle, half = 0.5 * (psi_rad + psi_rad[1]), 0.5 * (psi_rad - psi_rad[1])
    rho = shape.evaluate(middle[:, None] + half[:, None] * node)[2]
    return np.asarray(half * (rho @ weight))


def test_flow_never_runs_backwards_on_a_convex_roll() -> None:
    for pair in PAIRS.values():
        span = pair.over_one_turn()
        assert float(np.min(span.flow_a_m_s)) > -1e-6
        assert float(np.min(span.flow_b_m_s)) > -1e-6


def test_one_turn_delivers_one_perimeter() -> None:
    for pair in PAIRS.values():
        flow = pair.over_one_turn().flow_a_m_s
        assert 2.0 * np.pi * np.mean(flow) == pytest.approx(pair.a.shape.perimeter_m, rel=1e-9)


angles = st.floats(-20.0, 20.0)


@given(angles, angles, angles, st.sampled_from([-1, 1]), st.sampled_from([-1, 1]))
@settings(max_examples=40, deadline=None)
def test_turning_the_whole_machine_changes_only_the_direction(
    tilt: float, theta_a: float, theta_b: float, sigma_a: int, sigma_b: int
) -> None:
    shape_a, shape_b = orders(0.2, [(1, 1e-3, 0.2), (3, 1e-3, 1.0)]), ellipse(0.1, 0.103)
    spans = []
    for angle in (0.0, tilt):
        c = 0.7 * np.exp(1j * angle)
        a = Body(center_x_m=0.0, center_y_m=0.0, rotation=sigma_a, shape=shape_a)
        b = Body(center_x_m=c.real, center_y_m=c.imag, rotation=sigma_b, shape=shape_b)
        spans.append(
            common_tangent(
                a,
                b,
                theta_a - sigma_a * (tilt - angle),
                theta_b - sigma_b * (tilt - angle),
                3.0,
                5.0,
            )
        )
    for field in ("length_m", "arm_a_m", "arm_b_m", "flow_a_m_s", "flow_b_m_s", "phi_rate_rad_s"):
        plain, tilted = (float(getattr(span, field)) for span in spans)
        assert tilted == pytest.approx(plain, abs=1e-12)


@given(angles, angles)
@settings(max_examples=30, deadline=None)
def test_mirrored_machine_behaves_the_same(theta_a: float, theta_b: float) -> None:
    shape_a, shape_b = orders(0.2, [(1, 1e-3, 0.2), (3, 1e-3, 1.0)]), eccentric(0.1, 1e-3)
    spans = [
        common_tangent(
            Body(center_x_m=0.0, center_y_m=0.0, rotation=side, shape=shape_a),
            Body(center_x_m=0.7, center_y_m=0.2 * side, rotation=-side, shape=shape_b),
            theta_a,
            theta_b,
        )
        for side in (1, -1)
    ]
    assert spans[0].arm_a_m == pytest.approx(spans[1].arm_a_m, abs=1e-13)
    assert spans[0].length_m == pytest.approx(spans[1].length_m, abs=1e-13)
    assert spans[0].phi_rad == pytest.approx(-spans[1].phi_rad, abs=1e-13)


@given(angles, angles)
@settings(max_examples=30, deadline=None)
def test_mounting_angle_of_a_shape_is_an_offset_of_theta(offset: float, theta: float) -> None:
    pair: Pair = PAIRS["ellipse onto ellipse"]
    turned = Body(
        center_x_m=pair.a.center_x_m,
        center_y_m=pair.a.center_y_m,
        rotation=pair.a.rotation,
        shape=pair.a.shape.turned(offset),
    )
    plain = common_tangent(pair.a, pair.b, theta + offset, 0.3)
    assert common_tangent(turned, pair.b, theta, 0.3).length_m == pytest.approx(
        plain.length_m, abs=1e-12
    )


def test_results_broadcast() -> None:
    pair = PAIRS["ellipse"]
    span = common_tangent(pair.a, pair.b, np.zeros((3, 1)), np.zeros(4))
    assert span.phi_rad.shape == span.arm_b_m.shape == span.flow_a_m_s.shape == (3, 4)


@pytest.mark.parametrize(("sigma", "distance_m"), [((1, -1), 0.25), ((1, 1), 0.05)])
def test_overlapping_bodies_are_refused(sigma: tuple[int, int], distance_m: float) -> None:
    a = Body(center_x_m=0.0, center_y_m=0.0, rotation=sigma[0], shape=circle(0.2))
    b = Body(center_x_m=distance_m, center_y_m=0.0, rotation=sigma[1], shape=circle(0.1))
    with pytest.raises(PlantError, match="overlap"):
        common_tangent(a, b, 0.0, 0.0)


def test_rotation_other_than_one_is_refused() -> None:
    with pytest.raises(PlantError, match="rotation"):
        Body(center_x_m=0.0, center_y_m=0.0, rotation=0, shape=circle(0.1))
