"""Parts of the shape law against independent calculations."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from aff_runtime.base.errors import ConfigError
from aff_runtime.core.bandwidth import Band
from aff_runtime.core.compiled.binary import Arithmetic, chosen, using
from aff_runtime.core.impulse import from_response, from_taps
from aff_runtime.core.shape.basis import ShapeBasis
from aff_runtime.core.shape.bounds import PeakBound
from aff_runtime.core.shape.columns import ColumnState
from aff_runtime.core.shape.filter import LoopFilter
from aff_runtime.core.shape.kalman import ShapeFilter
from aff_runtime.core.shape.monitor import ShapeMonitor
from tests.aff_runtime.core.plants import CYCLE_S, LagDelay, measured
from tests.aff_runtime.core.shape_site import DRIVE, Phase

BAND = Band(full_Hz=17.0, end_Hz=19.0)


def test_the_basis_is_the_drive_inverse_in_steady_state():
    """b_n against the transfer function of the docstring, evaluated at j n omega."""
    omega, radius = 5.0, 0.2
    phase = Phase(omega, radius)
    basis = ShapeBasis([("unwind", 1), ("unwind", 3)], {"unwind": phase}, DRIVE, 0.0, BAND)
    for _ in range(2000):
        basis.step(omega * radius, 90.0, CYCLE_S)
        at = phase.theta_rad
        phase.turn()
    K, c, J = DRIVE.K_ref_rad_s, DRIVE.corner_rad_s, DRIVE.inertia_at(radius)
    for i, n in enumerate((1, 3)):
        s = 1j * n * omega
        rate = omega * (1.0 + s * s / (K * (s + c)))
        torque = radius * 90.0 / (J * K) * s / (s + c)
        assert basis.b[i] == pytest.approx(-(rate + torque) * cmath.exp(1j * n * at), rel=0.01)
    s = 1j * omega
    heavy = -100.0 * radius / (J * K) * s / (s + c) * cmath.exp(1j * at)
    assert basis.names[2] == "imbalance"
    assert basis.b[2] == pytest.approx(heavy, rel=0.01)


def test_what_sticks_out_is_heavy_where_the_web_is_known_to_leave():
    """Wound mass times g on a lever: at the side that goes down it pulls with the web."""
    side = math.radians(90.0)
    drive = replace(
        DRIVE, web_density_kg_m3=400.0, web_width_m=0.15, core_radius_m=0.05, web_leaves_rad=side
    )
    weight_N = 400.0 * 0.15 * math.pi * (0.2**2 - 0.05**2) * 9.80665
    assert drive.weight_of_shape_N(0.2) == pytest.approx(weight_N)
    bottom = replace(drive, web_leaves_rad=math.pi)
    assert bottom.weight_of_shape_N(0.2) == pytest.approx(1j * weight_N)
    assert replace(drive, web_leaves_rad=math.nan).weight_of_shape_N(0.2) == 0.0
    b = {}
    for name, used in (("known", drive), ("unknown", replace(drive, web_leaves_rad=math.nan))):
        phase = Phase(5.0, 0.2)
        basis = ShapeBasis([("unwind", 1), ("unwind", 2)], {"unwind": phase}, used, 0.0, BAND)
        for _ in range(2000):
            basis.step(1.0, 90.0, CYCLE_S)
            at = phase.theta_rad
            phase.turn()
        b[name] = basis.b.copy()
    K, c, J = drive.K_ref_rad_s, drive.corner_rad_s, drive.inertia_at(0.2)
    more = -weight_N * 0.2 / (J * K) * 5j / (5j + c) * cmath.exp(1j * at)
    assert b["known"][0] - b["unknown"][0] == pytest.approx(more, rel=0.01)
    assert b["known"][1:] == pytest.approx(b["unknown"][1:])


def test_inertia_grows_with_the_fourth_power_of_the_radius():
    drive = replace(DRIVE, web_density_kg_m3=400.0, web_width_m=0.15, core_radius_m=0.05)
    wound = 0.5 * math.pi * 400.0 * 0.15 * (0.2**4 - 0.05**4)
    assert drive.inertia_at(0.2) == pytest.approx(DRIVE.inertia_kg_m2 + wound)
    assert drive.inertia_at(0.05) == pytest.approx(DRIVE.inertia_kg_m2)


def test_the_loop_filter_is_a_convolution():
    rng = np.random.default_rng(5)
    taps = rng.standard_normal(40)
    loop = LoopFilter(from_taps((0.2,), [taps]), 2)
    plain = rng.standard_normal((100, 2)) + 1j * rng.standard_normal((100, 2))
    sent = rng.standard_normal((100, 2)) + 1j * rng.standard_normal((100, 2))
    for k in range(100):
        loop.push(plain[k], sent[k] / plain[k], 1.0, 1)
    phi, psi = loop.read()
    for i in range(2):
        assert phi[i] == pytest.approx(np.convolve(plain[:, i], taps)[99], rel=1e-12, abs=1e-12)
        assert psi[i] == pytest.approx(np.convolve(sent[:, i], taps)[99], rel=1e-12, abs=1e-12)


def test_taps_between_radii_are_linear_and_outside_the_nearest():
    loop = from_taps((0.1, 0.2), [np.zeros(3), np.ones(3)])
    assert loop.at(0.125) == pytest.approx(np.full(3, 0.25))
    assert loop.at(0.5) == pytest.approx(np.ones(3))
    assert loop.at(0.01) == pytest.approx(np.zeros(3))


def test_impulse_response_from_a_measured_curve_gives_the_curve_back():
    plant = LagDelay(300.0, delay=5, lag=0.9)
    response = measured(plant.at, np.geomspace(0.2, 15.0, 24), delay_s=0.03)
    loop = from_response(response, cycle_s=CYCLE_S, memory_s=2.0)
    for f in (0.4, 1.1, 3.0, 8.0):
        p = plant.at(f)
        assert abs(loop.response(f, CYCLE_S, 0.2) - p) < 0.06 * abs(p)


def two_modes(f: float) -> complex:
    """Return a response that rings for seconds: modes at 6.2 and 11 Hz, and a delay."""
    s = 2j * math.pi * f
    modes = ((30.0, 6.2, 0.03), (10.0, 11.0, 0.02))
    rates = [(gain, math.tau * Hz, zeta) for gain, Hz, zeta in modes]
    total = sum(g * s * w / (s * s + 2 * zeta * w * s + w * w) for g, w, zeta in rates)
    return total * cmath.exp(-0.02 * s)


@pytest.mark.parametrize("lowest_Hz", [0.7, 0.1, 0.05])
def test_a_low_tone_more_makes_no_high_order_less_known(lowest_Hz):
    """The curve is read as closely at 17 Hz whatever the lowest tone is."""
    tones = np.concatenate([[lowest_Hz], np.arange(0.9, 19.0, 0.3)])
    response = measured(two_modes, tones, delay_s=0.02)
    loop = from_response(response, cycle_s=CYCLE_S, memory_s=4.0)
    for f in np.arange(7.5, 17.0, 0.13):
        p = two_modes(f)
        assert abs(loop.response(f, CYCLE_S, 0.2) - p) < 0.2 * abs(p), f


@pytest.mark.parametrize("radii", [(0.2, 0.1), (0.1,), ()])
def test_a_loop_model_refuses_what_does_not_fit(radii):
    with pytest.raises(ConfigError):
        from_taps(radii, [np.zeros(3), np.zeros(3)] if radii else [])


def test_the_filter_agrees_with_batch_least_squares_under_its_prior():
    """Without process noise the recursive estimate is the regularised batch solution."""
    rng = np.random.default_rng(2)
    n, count = 2, 400

    class Still(ShapeFilter):
        def _predict(self, *given):
            """Keep everything for ever."""

    kalman = Still(n, 1e9, 0.5)
    rows, errors = [], []
    zero = np.zeros(n, dtype=complex)
    prior = kalman._start.copy()
    for k in range(count):
        phi = 500.0 * np.exp(1j * np.array([0.05 * k, 0.1 * k]))
        error = 0.4 * math.cos(0.05 * k) - 0.7 * math.sin(0.1 * k) + 0.5 * rng.standard_normal()
        kalman.update(error, phi, zero, np.ones(n), CYCLE_S)
        rows.append(np.concatenate([phi.conj().view(float), np.zeros(2 * n), [1.0]]))
        errors.append(error)
    H = np.array(rows)
    batch = np.linalg.solve(H.T @ H / 0.25 + np.diag(1 / prior), H.T @ np.array(errors) / 0.25)
    batch[2 * n : 4 * n : 2] += 1.0  # P is taken as right until readings say otherwise
    assert kalman.state == pytest.approx(batch, abs=1e-7, rel=1e-5)
    assert np.allclose(kalman.covariance, kalman.covariance.T, rtol=0, atol=1e-15)


@pytest.mark.parametrize(("spike_N", "counts_N"), [(3.0, 3.0), (100.0, 10.0), (-100.0, -10.0)])
@pytest.mark.parametrize("arithmetic", [chosen(), None], ids=["as_installed", "numpy"])
def test_a_spike_moves_the_state_as_ten_standard_deviations_do(
    spike_N: float, counts_N: float, arithmetic: Arithmetic | None
) -> None:
    """Of a reading's expected spread; once much was learned that is the sensor's noise alone."""
    with using(arithmetic):
        kalman = ShapeFilter(1, 1e9, 1.0)
    for k in range(4000):
        phi = np.array([500.0 * cmath.exp(0.05j * k)])
        kalman.update(0.0, phi, np.zeros(1, dtype=complex), np.ones(1), CYCLE_S)
    before, spread = kalman.state.copy(), kalman.covariance.copy()
    h = np.array([500.0, 0.0, 0.0, 0.0, 1.0])
    variance = float(h @ spread @ h) + 1.0
    assert variance == pytest.approx(1.0, abs=0.2)
    kalman.update(spike_N, np.array([500.0 + 0j]), np.zeros(1, dtype=complex), np.ones(1), CYCLE_S)
    news = min(abs(counts_N), abs(spike_N) / math.sqrt(variance)) * math.copysign(1.0, spike_N)
    expected = before + spread @ h / math.sqrt(variance) * news
    assert kalman.state == pytest.approx(expected, rel=1e-3, abs=1e-9)
    assert kalman.innovation == pytest.approx(spike_N, abs=0.2)


def test_variances_never_grow_past_their_start():
    kalman = ShapeFilter(2, 6.0, 0.6)
    zero = np.zeros(2, dtype=complex)
    for _ in range(2000):
        kalman.update(0.0, zero, zero, np.full(2, 1.0), CYCLE_S)
    assert (kalman._diagonal <= kalman._start * (1 + 1e-9)).all()
    assert (kalman._diagonal > 0).all()


def test_a_spoilt_covariance_is_started_again_and_the_state_kept():
    kalman = ShapeFilter(1, 6.0, 0.6)
    kalman.state[0] = 0.001
    kalman.covariance[1, 1] = -1.0
    kalman.check()
    assert kalman.state[0] == 0.001
    assert kalman.covariance[1, 1] > 0.0


def test_the_peak_bound_covers_the_turn_and_is_closer_than_the_sum():
    rng = np.random.default_rng(1)
    order = np.arange(1.0, 9.0)
    parts = rng.standard_normal(8) + 1j * rng.standard_normal(8)
    bound = PeakBound(order, ["a"] * 8, "a")
    peak, slew = bound.of(parts, np.ones(8), np.full(8, 3.0))
    turned = np.exp(0.1j * order)
    assert bound.of(parts * turned, turned, np.full(8, 3.0)) == pytest.approx((peak, slew))
    angle = np.linspace(0, math.tau, 20001)
    wave = (parts[:, None] * np.exp(1j * order[:, None] * angle)).real.sum(axis=0)
    rate = (1j * 3.0 * order[:, None] * parts[:, None] * np.exp(1j * order[:, None] * angle)).real
    assert np.abs(wave).max() <= peak <= 1.03 * np.abs(wave).max()
    assert np.abs(rate.sum(axis=0)).max() <= slew
    assert peak < np.abs(parts).sum()


FOUND = SimpleNamespace(deviation=np.array([1e-3 + 0j]), response_ratio=np.array([1.0 + 0j]))


def test_a_column_that_does_harm_is_faded_and_rests():
    monitor = ShapeMonitor(ColumnState(1), ["a"], 0.1)
    phi, turn = np.array([1000.0 + 0j]), np.array([1.0])
    for k in range(2000):
        angle = np.exp(1j * math.tau * k * CYCLE_S)
        monitor.step(3.0 * angle.real, phi * angle, FOUND, turn, CYCLE_S)
    assert monitor.share[0] == 0.0
    assert monitor.resting[0]


def test_a_column_that_helps_is_left_alone():
    monitor = ShapeMonitor(ColumnState(1), ["a"], 0.1)
    phi, turn = np.array([1000.0 + 0j]), np.array([1.0])
    for k in range(2000):
        angle = np.exp(1j * math.tau * k * CYCLE_S)
        monitor.step(0.2 * angle.real, phi * angle, FOUND, turn, CYCLE_S)
    assert monitor.share[0] == 1.0
    assert monitor.now[0] == pytest.approx(0.2, rel=0.2)
    assert monitor.without[0] == pytest.approx(1.0)


def test_only_orders_of_different_rolls_can_meet():
    monitor = ShapeMonitor(ColumnState(3), ["a", "a", "b"], 0.1)
    monitor.compare(np.array([1.0, 1.0, 2.0]), np.ones(3), 6.0)
    assert not monitor.meets.any()
    monitor.compare(np.array([1.0, 2.0, 2.1]), np.ones(3), 6.0)
    assert list(monitor.meets) == [False, True, True]
