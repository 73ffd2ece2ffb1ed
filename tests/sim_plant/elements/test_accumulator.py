"""Accumulator: rest, conservation of web, frequency response against a transfer function."""

import numpy as np
import pytest

from sim_plant.line.alone.accumulator_section import Accumulator, rates, rest_lift_N, simulate
from sim_plant.line.alone.dancer_section import phasor

V, EPS_UP, V_OUT, HEIGHT = 2.0, 0.004, 2.004, 1.5
A = Accumulator(EA_N=9300.0, strain_upstream=EPS_UP, spans=10, mass_kg=200.0, damping_N_s_m=500.0)
STRAIN = (1.0 + EPS_UP) * V_OUT / V - 1.0
REST = np.array([STRAIN, HEIGHT, 0.0])
LIFT = rest_lift_N(A, STRAIN)


def test_rests_where_lift_carries_carriage_and_all_spans() -> None:
    np.testing.assert_allclose(rates(A, REST, (V, V_OUT), LIFT), 0.0, atol=1e-9)
    assert pytest.approx(200.0 * 9.80665 + 10 * 9300.0 * STRAIN) == LIFT


def test_a_stopped_inlet_drains_it_at_the_outlet_speed() -> None:
    # splice: nothing enters, v_out leaves: N dx/dt = -v_out once tension has settled
    states = simulate(A, REST, lambda _t: (0.0, V_OUT), LIFT, 3.0, 1e-3)
    assert np.mean(states[-1000:, 2]) == pytest.approx(-V_OUT / 10.0, rel=0.02)


def test_unstretched_length_is_conserved() -> None:
    step = 5e-4

    def speeds(t: float) -> tuple[float, float]:
        return V * (1.0 + 0.1 * np.sin(3.0 * t)), V_OUT

    states = simulate(A, REST, speeds, LIFT, 3.0, step)
    content = 10.0 * states[:, 1] / (1.0 + states[:, 0])
    time = step * np.arange(len(states))
    entering = np.array([speeds(t)[0] for t in time]) / (1.0 + EPS_UP)
    net = entering - V_OUT / (1.0 + states[:, 0])
    stored = np.concatenate(([0.0], np.cumsum(0.5 * step * (net[1:] + net[:-1]))))
    assert np.ptp(content) > 0.01
    np.testing.assert_allclose(content - content[0], stored, atol=1e-7)


def test_energy_is_conserved_between_clamped_ends() -> None:
    free = Accumulator(
        EA_N=9300.0, strain_upstream=STRAIN, spans=10, mass_kg=200.0, damping_N_s_m=0.0
    )
    start = np.array([STRAIN, HEIGHT, 0.02])
    states = simulate(free, start, lambda _t: (0.0, 0.0), LIFT, 3.0, 5e-4)
    unstretched = 10.0 * HEIGHT / (1.0 + STRAIN)
    total = (
        0.5 * 200.0 * states[:, 2] ** 2
        + 0.5 * 9300.0 * states[:, 0] ** 2 * unstretched
        - (LIFT - 200.0 * 9.80665) * states[:, 1]
    )
    assert np.ptp(states[:, 2]) > 0.02
    np.testing.assert_allclose(total, total[0], atol=1e-6)


@pytest.mark.parametrize("frequency_Hz", [0.2, 0.6, 2.0])
@pytest.mark.sweep(every=6)
def test_frequency_response_is_that_of_the_transfer_function(frequency_Hz: float) -> None:
    """eps/v_in with s: (L s/(1+eps) + V/(1+up)) e = N Vc - k v_in; M s Vc = -c Vc - N EA e."""
    s = 2j * np.pi * frequency_Hz
    k = 1.0 + (STRAIN - EPS_UP) / (1.0 + EPS_UP)
    carriage = -10.0 * 9300.0 / (200.0 * s + 500.0)
    expected = -k / (10.0 * HEIGHT * s / (1.0 + STRAIN) + V / (1.0 + EPS_UP) - 10.0 * carriage)
    size, step = 1e-3, 5e-3  # within 1e-5 of what it is at 1 ms

    def speeds(t: float) -> tuple[float, float]:
        return V + size * np.cos(2.0 * np.pi * frequency_Hz * t), V_OUT

    # begun in the expected motion, so that nothing has to die away
    first = expected * np.array([1.0, carriage / s, carriage])
    states = simulate(A, REST + size * first.real, speeds, LIFT, 8.0, step)
    found = phasor(states[:, 0], step, frequency_Hz, 1) / size
    assert found == pytest.approx(expected, rel=0.02)
