"""Linear dancer: rest, conservation, frequency response against hand-made matrices."""

import numpy as np
import pytest

from sim_plant.line.alone.dancer_section import (
    DancerWeb,
    LinearDancer,
    phasor,
    rates,
    rest_strain,
    simulate,
)

V = 1.0
EPS_UP = 0.005
WEB = DancerWeb(
    EA_N=9300.0,
    strain_upstream=EPS_UP,
    length_in_m=1.0,
    length_out_m=0.8,
    roller_radius_m=0.0381,
    roller_inertia_kg_m2=0.0014,
)
V_OUT = V * 1.004
STRAIN = rest_strain(WEB, V, V_OUT)
LOAD = 2.0 * WEB.EA_N * STRAIN
DANCER = LinearDancer(mass_kg=2.0, load_N=LOAD, stiffness_N_m=300.0, damping_N_s_m=60.0)
REST = np.array([STRAIN, STRAIN, V_OUT, 0.0, 0.0])


def test_rests_where_load_balances_both_tensions() -> None:
    np.testing.assert_allclose(rates(WEB, DANCER, REST, (V, V_OUT)), 0.0, atol=1e-9)


def test_heavier_load_moves_it_until_the_spring_takes_the_rest() -> None:
    # tension is set by the speeds, so the spring carries the extra load: x = dF / k
    heavier = LinearDancer(
        mass_kg=2.0, load_N=LOAD + 500.0, stiffness_N_m=5e4, damping_N_s_m=600.0
    )
    states = simulate(WEB, heavier, REST, lambda _t: (V, V_OUT), 15.0, 4e-3)
    assert states[-1, 3] == pytest.approx(500.0 / 5e4, rel=5e-3)
    assert states[-1, 0] == pytest.approx(STRAIN, rel=5e-3)  # the slow mode of transport


def test_unstretched_length_is_conserved() -> None:
    def speeds(t: float) -> tuple[float, float]:
        return V, V_OUT + 0.02 * np.sin(7.0 * t)

    step = 5e-4
    states = simulate(WEB, DANCER, REST, speeds, 2.0, step)
    eps_in, eps_out, q = states[:, 0], states[:, 1], states[:, 3]
    content = (WEB.length_in_m + q) / (1.0 + eps_in) + (WEB.length_out_m + q) / (1.0 + eps_out)
    time = step * np.arange(len(states))
    leaving = np.array([speeds(t)[1] for t in time]) / (1.0 + eps_out)
    net = V / (1.0 + EPS_UP) - leaving
    stored = np.concatenate(([0.0], np.cumsum(0.5 * step * (net[1:] + net[:-1]))))
    assert np.ptp(content) > 1e-3
    np.testing.assert_allclose(content - content[0], stored, atol=1e-8)


def test_energy_is_conserved_when_nothing_drives_or_damps() -> None:
    web = DancerWeb(
        EA_N=9300.0,
        strain_upstream=STRAIN,
        length_in_m=1.0,
        length_out_m=1.0,
        roller_radius_m=0.0381,
        roller_inertia_kg_m2=0.0014,
    )
    free = LinearDancer(mass_kg=2.0, load_N=LOAD, stiffness_N_m=300.0, damping_N_s_m=0.0)
    start = np.array([STRAIN, STRAIN, 0.0, 0.0, 0.03])
    states = simulate(web, free, start, lambda _t: (0.0, 0.0), 2.0, 5e-4)
    eps, q, rate = states[:, 0], states[:, 3], states[:, 4]
    unstretched = 1.0 / (1.0 + STRAIN)
    kinetic = 0.5 * 2.0 * rate**2
    stored = 2.0 * 0.5 * web.EA_N * eps**2 * unstretched + 0.5 * 300.0 * q**2 - LOAD * q
    total = kinetic + stored
    assert np.ptp(kinetic) > 5e-4
    np.testing.assert_allclose(total, total[0], atol=1e-8)


def linear_model(frequency_Hz: float) -> np.ndarray:
    """Return d(eps_in, eps_out, u, x, x') per m/s of outlet speed, from matrices by hand."""
    grow, renew = 1.0 + STRAIN, V / (1.0 + EPS_UP)
    l1, l2 = WEB.length_in_m, WEB.length_out_m
    spin = WEB.roller_radius_m**2 * WEB.EA_N / WEB.roller_inertia_kg_m2
    m, k, c = DANCER.mass_kg, DANCER.stiffness_N_m, DANCER.damping_N_s_m
    A = np.zeros((5, 5))
    A[0] = grow / l1 * np.array([-renew, 0.0, 1.0, 0.0, 1.0])
    A[1] = grow / l2 * np.array([V_OUT / grow, -V_OUT / grow, -1.0, 0.0, 1.0])
    A[2] = [-spin, spin, 0.0, 0.0, 0.0]
    A[3, 4] = 1.0
    A[4] = [-WEB.EA_N / m, -WEB.EA_N / m, 0.0, -k / m, -c / m]
    B = np.array([0.0, grow / l2, 0.0, 0.0, 0.0])
    s = 2j * np.pi * frequency_Hz
    return np.asarray(np.linalg.solve(s * np.eye(5) - A, B))


@pytest.mark.parametrize("frequency_Hz", [0.5, 2.0, 5.0, 12.0])
@pytest.mark.sweep(every=2)
def test_frequency_response_is_that_of_the_linear_model(frequency_Hz: float) -> None:
    # whole steps a period; within 1e-4 of what it is at 1 ms
    size, step = 1e-4, min(4e-3, 0.02 / frequency_Hz)

    def speeds(t: float) -> tuple[float, float]:
        return V, V_OUT + size * np.cos(2.0 * np.pi * frequency_Hz * t)

    expected = linear_model(frequency_Hz)
    # begun in the expected motion, so that nothing has to die away
    states = simulate(WEB, DANCER, REST + size * expected.real, speeds, 5.0, step)
    for column in (0, 1, 3):
        found = phasor(states[:, column], step, frequency_Hz, 2) / size
        assert found == pytest.approx(expected[column], rel=0.01, abs=1e-6)
