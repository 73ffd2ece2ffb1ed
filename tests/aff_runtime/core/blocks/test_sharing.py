"""Gain sharing, speed gate, residual and order monitor, each alone."""

import cmath
import math

import pytest

from aff_runtime.core.blocks.sharing import gain_share
from aff_runtime.core.gate import SpeedGate
from aff_runtime.core.monitor import OrderMonitor, OrderState
from aff_runtime.core.residual import Residual


def test_coincident_blocks_use_together_the_gain_of_one():
    for count in (1, 2, 3):
        shares = [gain_share(i, [6.0] * count, [0.5] * count) for i in range(count)]
        assert sum(shares) == pytest.approx(1.0)


def test_distant_blocks_keep_their_gain_and_the_band_scales_with_the_rate():
    assert gain_share(0, [6.0, 8.1], [0.5, 0.5]) == 1.0
    assert gain_share(0, [6.0, 8.1], [1.0, 1.0]) < 1.0
    steps = [gain_share(0, [6.0, 6.0 + d], [0.5, 0.5]) for d in (0.0, 0.5, 1.0, 1.9, 2.0)]
    assert steps == sorted(steps)


def test_gate_opens_above_closes_below_and_ramps():
    gate = SpeedGate(0.1)
    assert gate.step(0.11, 0.1) == 0.0  # between threshold and hysteresis: stays shut
    assert gate.step(0.13, 0.1) == pytest.approx(0.2)
    assert gate.step(0.11, 0.1) == pytest.approx(0.4)  # stays open down to the threshold
    assert gate.step(0.09, 0.1) == pytest.approx(0.2)
    assert gate.step(math.nan, 0.1) == pytest.approx(0.0, abs=1e-12)


def test_residual_has_no_mean_and_counts_time_over_duplicates():
    residual = Residual(2.0)
    for k in range(4000):
        value = residual.step(
            signal=90 + math.sin(0.05 * k), reference=88.0, dt_s=0.005, fresh=True
        )
    assert abs(value + math.sin(0.05 * 3999)) < 0.06
    assert math.isnan(residual.step(signal=90.0, reference=88.0, dt_s=0.005, fresh=False))
    residual.step(signal=90.0, reference=88.0, dt_s=0.005, fresh=True)
    assert residual.elapsed_s == pytest.approx(0.01)


def test_residual_tells_its_own_response():
    residual, f = Residual(0.5), 0.4
    total = 0j
    for k in range(20000):
        t = k * 0.005
        value = residual.step(
            signal=-math.cos(math.tau * f * t), reference=0.0, dt_s=0.005, fresh=True
        )
        if k >= 15000:
            total += 2 * value * cmath.exp(-1j * math.tau * f * t) / 5000
    assert total == pytest.approx(residual.response(f), abs=0.02)


def test_monitor_reads_amplitude_and_keeps_the_one_before():
    monitor, omega = OrderMonitor(), 6.0
    for k in range(6000):
        size = 2.0 if k < 3000 else 0.2
        carrier = cmath.exp(1j * omega * 0.005 * k)
        monitor.step(
            error=(size * carrier * 1j).real,
            carrier=carrier,
            omega_rad_s=omega,
            dt_s=0.005,
            correcting=k >= 3000,
        )
        if k == 3100:
            assert monitor.state() is OrderState.CONVERGING
    assert monitor.before == pytest.approx(2.0, rel=0.05)
    assert monitor.now == pytest.approx(0.2, rel=0.1)
    assert monitor.state() is OrderState.SETTLED
