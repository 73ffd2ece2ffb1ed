"""Pendulum dancer: levers against a taut string, rest, conservation, linear response."""

import cmath
import math

import numpy as np
import pytest

from sim_plant.elements.pendulum_dancer import span_lever
from sim_plant.line.alone.dancer_section import (
    DancerWeb,
    PendulumDancer,
    phasor,
    rates,
    rest_strain,
    simulate,
)

RADIUS, ARM, REACH = 0.0381, 0.4, -2.0 * 0.0381
BEFORE, AFTER = (0.25, 0.6), (0.55, 0.6)
V, EPS_UP = 1.0, 0.005
V_OUT = V * 1.004
LEVELS = (
    span_lever(0.0, 0.0, ARM, 0.0, *BEFORE, REACH, True),
    span_lever(0.0, 0.0, ARM, 0.0, *AFTER, -REACH, False),
)
WEB = DancerWeb(
    EA_N=9300.0,
    strain_upstream=EPS_UP,
    length_in_m=LEVELS[0][1],
    length_out_m=LEVELS[1][1],
    roller_radius_m=RADIUS,
    roller_inertia_kg_m2=0.0014,
)
STRAIN = rest_strain(WEB, V, V_OUT)
WEIGHT = 15.0
LOAD = WEIGHT + (LEVELS[0][0] + LEVELS[1][0]) * WEB.EA_N * STRAIN
DANCER = PendulumDancer(
    inertia_kg_m2=0.5,
    load_N_m=LOAD,
    weight_N_m=WEIGHT,
    damping_N_m_s=8.0,
    arm_m=ARM,
    before_m=BEFORE,
    after_m=AFTER,
    reach_in_m=REACH,
    reach_out_m=-REACH,
)
REST = np.array([STRAIN, STRAIN, V_OUT, 0.0, 0.0])


def path_m(q: float) -> float:
    """Return the taut path over fixed roller, dancer roller, fixed roller: chords and arcs.

    Rollers before and after turn counter-clockwise, the dancer roller clockwise, all of RADIUS;
    crossed tangents pass the midpoint of the centres. Arcs are counted from fixed directions.
    """
    dancer = cmath.rect(ARM, q)
    first, last = complex(*BEFORE), complex(*AFTER)

    def crossed(a: complex, b: complex, sense: float) -> tuple[float, float]:
        d = abs(b - a)
        lean = math.asin(2.0 * RADIUS / d)
        return math.sqrt(d * d - 4.0 * RADIUS**2), cmath.phase(b - a) + sense * lean

    length_in, direction_in = crossed(first, dancer, 1.0)
    length_out, direction_out = crossed(dancer, last, -1.0)
    turn_before = direction_in  # + radius x change of direction on a ccw roller
    turn_dancer = direction_in - direction_out
    turn_after = -direction_out
    return length_in + length_out + RADIUS * (turn_before + turn_dancer + turn_after)


def test_levers_are_the_derivative_of_a_taut_string() -> None:
    for q in (-0.3, 0.0, 0.25):
        lever_in, _ = span_lever(0.0, 0.0, ARM, q, *BEFORE, REACH, True)
        lever_out, _ = span_lever(0.0, 0.0, ARM, q, *AFTER, -REACH, False)
        slope = (path_m(q + 1e-5) - path_m(q - 1e-5)) / 2e-5
        assert lever_in + lever_out == pytest.approx(slope, abs=1e-8)


def test_rests_where_load_balances_weight_and_tensions() -> None:
    np.testing.assert_allclose(rates(WEB, DANCER, REST, (V, V_OUT)), 0.0, atol=1e-9)


def test_unstretched_length_of_the_whole_path_is_conserved() -> None:
    """With both ends clamped (path + wraps) / (1 + strain) cannot change."""
    light = DancerWeb(
        EA_N=9300.0,
        strain_upstream=STRAIN,
        length_in_m=WEB.length_in_m,
        length_out_m=WEB.length_out_m,
        roller_radius_m=RADIUS,
        roller_inertia_kg_m2=1e-5,
    )
    start = np.array([STRAIN, STRAIN, 0.0, 0.0, 0.05])
    step = 2e-4
    states = simulate(light, DANCER, start, lambda _t: (0.0, 0.0), 0.4, step)
    lengths = np.array([DANCER.geometry(light, q)[1::2] for q in states[:, 3]])
    stretch = np.sum(lengths * (states[:, :2] - STRAIN), axis=1)
    path = np.array([path_m(q) for q in states[:, 3]])
    assert np.ptp(path) > 1e-4
    np.testing.assert_allclose(stretch, (path - path[0]) * (1.0 + STRAIN), rtol=0.02, atol=2e-6)


def test_energy_is_conserved_when_nothing_drives_or_damps() -> None:
    free = PendulumDancer(
        inertia_kg_m2=0.5,
        load_N_m=LOAD,
        weight_N_m=WEIGHT,
        damping_N_m_s=0.0,
        arm_m=ARM,
        before_m=BEFORE,
        after_m=AFTER,
        reach_in_m=REACH,
        reach_out_m=-REACH,
    )
    start = np.array([STRAIN, STRAIN, 0.0, 0.0, 0.05])
    states = simulate(WEB, free, start, lambda _t: (0.0, 0.0), 1.0, 2e-4)
    lengths = np.array([free.geometry(WEB, q)[1::2] for q in states[:, 3]])
    elastic = np.sum(0.5 * WEB.EA_N * states[:, :2] ** 2 * lengths / (1.0 + states[:, :2]), axis=1)
    spin = 0.5 * 0.0014 * (states[:, 2] / RADIUS) ** 2
    swing = 0.5 * 0.5 * states[:, 4] ** 2
    potential = WEIGHT * np.sin(states[:, 3]) - LOAD * states[:, 3]
    total = elastic + spin + swing + potential
    assert np.ptp(swing) > 5e-4
    # web that wanders onto the wraps takes its strain energy along, some per cent of the swing
    assert np.ptp(total) < 0.04 * np.ptp(swing)


def linear_model(frequency_Hz: float) -> np.ndarray:
    """Return d(eps_in, eps_out, u, q, q') per m/s of outlet speed, levers from the taut string."""
    h = 1e-4
    bend = (path_m(h) - 2.0 * path_m(0.0) + path_m(-h)) / h**2
    (b_in, l_in), (b_out, l_out) = LEVELS
    grow, renew = 1.0 + STRAIN, V / (1.0 + EPS_UP)
    spin = RADIUS**2 * WEB.EA_N / WEB.roller_inertia_kg_m2
    J, pull = 0.5, WEB.EA_N * STRAIN
    A = np.zeros((5, 5))
    A[0] = grow / l_in * np.array([-renew, 0.0, 1.0, 0.0, b_in])
    A[1] = grow / l_out * np.array([V_OUT / grow, -V_OUT / grow, -1.0, 0.0, b_out])
    A[2] = [-spin, spin, 0.0, 0.0, 0.0]
    A[3, 4] = 1.0
    A[4] = [-b_in * WEB.EA_N / J, -b_out * WEB.EA_N / J, 0.0, -bend * pull / J, -8.0 / J]
    s = 2j * np.pi * frequency_Hz
    return np.asarray(np.linalg.solve(s * np.eye(5) - A, [0.0, grow / l_out, 0.0, 0.0, 0.0]))


@pytest.mark.parametrize("frequency_Hz", [1.0, 3.0, 8.0])
@pytest.mark.sweep(every=6)
def test_frequency_response_is_that_of_the_linear_model(frequency_Hz: float) -> None:
    # whole steps a period; within 1e-4 of what it is at 1 ms
    size, step = 1e-4, min(4e-3, 0.02 / frequency_Hz)

    def speeds(t: float) -> tuple[float, float]:
        return V, V_OUT + size * np.cos(2.0 * np.pi * frequency_Hz * t)

    expected = linear_model(frequency_Hz)
    # begun in the expected motion, so that nothing has to die away
    states = simulate(WEB, DANCER, REST + size * expected.real, speeds, 4.0, step)
    for column in (0, 1, 3):
        found = phasor(states[:, column], step, frequency_Hz, 2) / size
        assert found == pytest.approx(expected[column], rel=0.02, abs=1e-6)
