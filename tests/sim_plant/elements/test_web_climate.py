"""Warm web: rest, mass with changing density, frequency response against a transfer function."""

import numpy as np
import pytest

from sim_plant.elements.web_climate import exchange_rate, free_strain, mass_per_length
from sim_plant.line.alone.climate_section import WarmSpan, pull_N, rates, simulate
from sim_plant.line.alone.dancer_section import phasor

V, EPS_UP = 1.0, 0.005
V_OUT = V * 1.004
SPAN = WarmSpan(
    EA_N=9300.0, strain_upstream=EPS_UP, length_m=2.0, expansion_1_K=6e-5, exchange_s=1.5
)
STRAIN = (1.0 + EPS_UP) * V_OUT / V - 1.0


def warm_at_rest(oven_K: float) -> float:
    # renewal v/L and exchange 1/tau in parallel
    renewal = V / SPAN.length_m
    return oven_K / SPAN.exchange_s / (renewal + 1.0 / SPAN.exchange_s)


def test_rests_where_renewal_and_oven_balance() -> None:
    state = np.array([STRAIN, warm_at_rest(40.0)])
    np.testing.assert_allclose(rates(SPAN, state, (V, V_OUT), 40.0), 0.0, atol=1e-12)


def test_speeds_set_the_strain_so_heat_costs_tension() -> None:
    cold = np.array([STRAIN, 0.0])
    states = simulate(SPAN, cold, lambda _t: (V, V_OUT), lambda _t: 40.0, 30.0, 5e-3)
    assert states[-1, 0] == pytest.approx(STRAIN)
    drop = pull_N(SPAN, STRAIN, 0.0) - pull_N(SPAN, float(states[-1, 0]), float(states[-1, 1]))
    assert drop == pytest.approx(9300.0 * 6e-5 * warm_at_rest(40.0), rel=1e-6)


def test_mass_is_conserved_while_density_changes() -> None:
    """Mass in the span = rho A L with the density of the warm web; speeds swing too."""
    step, reference = 1e-3, 0.0114

    def speeds(t: float) -> tuple[float, float]:
        return V, V_OUT + 0.01 * np.sin(3.0 * t)

    states = simulate(SPAN, np.array([STRAIN, 0.0]), speeds, lambda _t: 60.0, 4.0, step)
    density = np.array([mass_per_length(reference, float(e)) for e in states[:, 0]])
    mass = density * SPAN.length_m
    time = step * np.arange(len(states))
    out = density * np.array([speeds(t)[1] for t in time])
    net = mass_per_length(reference, EPS_UP) * V - out
    stored = np.concatenate(([0.0], np.cumsum(0.5 * step * (net[1:] + net[:-1]))))
    assert np.ptp(mass) > 1e-5
    np.testing.assert_allclose(mass - mass[0], stored, atol=1e-10)


@pytest.mark.parametrize("frequency_Hz", [0.05, 0.2, 1.0])
@pytest.mark.sweep(every=3)
def test_tension_follows_the_oven_as_the_transfer_function_says(frequency_Hz: float) -> None:
    # T/oven = -EA alpha (1/tau) / (s + v/L + 1/tau): strain stays, free strain moves
    s = 2j * np.pi * frequency_Hz
    expected = -9300.0 * 6e-5 / 1.5 / (s + V / 2.0 + 1.0 / 1.5)
    step = 5e-3
    states = simulate(
        SPAN,
        np.array([STRAIN, warm_at_rest(40.0)]),
        lambda _t: (V, V_OUT),
        lambda t: 40.0 + 5.0 * np.cos(2.0 * np.pi * frequency_Hz * t),
        40.0,
        step,
    )
    pull = np.array([pull_N(SPAN, float(e), float(w)) for e, w in states])
    assert phasor(pull, step, frequency_Hz, 1) / 5.0 == pytest.approx(expected, rel=0.01)


def test_moisture_swells_like_heat() -> None:
    assert free_strain(6e-5, 10.0, 0.1, 0.02) == pytest.approx(6e-4 + 2e-3)
    assert exchange_rate(0.02, 0.0, 0.05, 0.5, 2.0) == pytest.approx(0.5 * -0.02 + 0.015)
