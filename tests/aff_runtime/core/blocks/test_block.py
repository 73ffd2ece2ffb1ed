"""A single block on plants of known phase."""

import cmath
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aff_runtime.core.blocks.block import HarmonicBlock
from tests.aff_runtime.core.plants import CYCLE_S, LagDelay

FREQUENCY_HZ = 1.0
TURN = round(1 / (FREQUENCY_HZ * CYCLE_S))


def residual_ratio(plant, seconds, *, settle_s, assumed=None, start_s=0.0):
    """Amplitude left after `seconds`, as a share of the start, by demodulating a turn."""
    block = HarmonicBlock(1, settle_s, 1e9)
    rate = block.adaptation_rate(0.0)
    response = plant.at(FREQUENCY_HZ) if assumed is None else assumed
    disturbance = 3.0 * cmath.exp(0.7j)
    u, seen = 0.0, []
    for k in range(round(seconds / CYCLE_S)):
        theta = math.tau * FREQUENCY_HZ * k * CYCLE_S
        y = plant.step(u) + (disturbance * cmath.exp(1j * theta)).real
        seen.append(y * cmath.exp(-1j * theta))
        block.turn(theta)
        block.adapt(error=-y, response=response, scale=1.0, rate_1_s=rate, dt_s=CYCLE_S)
        u = block.output(1.0)
    return abs(2 * sum(seen[-TURN:]) / TURN) / 3.0


@pytest.mark.parametrize("degrees", range(-180, 180, 30))
def test_converges_for_every_phase_of_the_response(degrees):
    # delay of d + 1 samples turns 360 (d + 1) / 200 degrees at 1 Hz; a negative gain half a turn
    lag = (-degrees) % 180
    delay = max(0, round(lag * TURN / 360) - 1)
    plant = LagDelay(-50.0 if (-degrees) % 360 >= 180 else 50.0, delay)
    wrapped = math.degrees(cmath.phase(plant.at(FREQUENCY_HZ)))
    assert abs(math.remainder(wrapped - degrees, 360)) < 3
    assert residual_ratio(plant, 40, settle_s=20) < 0.02


@pytest.mark.parametrize("settle_s", [10.0, 20.0, 40.0])
def test_settle_s_is_the_time_to_two_percent(settle_s):
    plant = LagDelay(120.0, delay=3)
    # the last turn averages from T-1 s to T s: expected share at its middle
    for part in (0.5, 1.0):
        seconds = part * settle_s
        expected_log = -4.0 * (seconds - 0.5) / settle_s
        got = residual_ratio(LagDelay(120.0, delay=3), seconds, settle_s=settle_s)
        assert math.log(got) == pytest.approx(expected_log, rel=0.1)
    assert plant.y == 0.0


@pytest.mark.parametrize(
    ("error_deg", "stable"), [(-80, True), (80, True), (110, False), (-110, False)]
)
def test_ninety_degrees_of_phase_error_part_converging_from_diverging(error_deg, stable):
    plant = LagDelay(50.0, delay=9)
    wrong = plant.at(FREQUENCY_HZ) * cmath.exp(1j * math.radians(error_deg))
    left = residual_ratio(plant, 40, settle_s=10, assumed=wrong)
    assert (left < 0.3) if stable else (left > 3.0)


def test_gain_matches_the_sources_symbols():
    # (5.7) with g1 = -2 lam / |P| and phi = arg P, u = -theta1 sin - theta2 cos
    block, psi, phi, gain, rate, error = HarmonicBlock(1, 10.0, 1e9), 0.9, 2.1, 40.0, 0.4, 0.25
    block.turn(psi)
    block.adapt(error=error, response=cmath.rect(gain, phi), scale=1.0, rate_1_s=rate, dt_s=0.005)
    g1 = -2 * rate / gain
    theta1, theta2 = (
        g1 * error * math.sin(psi + phi) * 0.005,
        g1 * error * math.cos(psi + phi) * 0.005,
    )
    assert block.weight == pytest.approx(complex(-theta2, theta1))
    assert block.output(1.0) == pytest.approx(-theta1 * math.sin(psi) - theta2 * math.cos(psi))


def test_weight_in_metres_gives_output_in_proportion_to_speed():
    block = HarmonicBlock(2, 10.0, 1e9)
    block.weight = 3e-4 + 1e-4j
    block.turn(0.4)
    assert block.output(8.0) == pytest.approx(2 * block.output(4.0))
    assert block.amplitude(-8.0) == pytest.approx(8.0 * math.hypot(3e-4, 1e-4))


def test_zero_rate_changes_nothing():
    block = HarmonicBlock(1, 10.0, 1.0)
    block.weight = 0.1 + 0.2j
    block.adapt(error=5.0, response=1 + 1j, scale=1.0, rate_1_s=0.0, dt_s=0.005)
    assert block.weight == 0.1 + 0.2j


BAD = st.sampled_from([math.nan, math.inf, -math.inf, 1e308, -1e308, 0.0])
ANY = BAD | st.floats(-1e6, 1e6)


@settings(max_examples=200, deadline=None)
@given(error=ANY, re=ANY, im=ANY, scale=ANY, theta=st.floats(-1e9, 1e9))
def test_no_input_makes_the_output_other_than_finite(error, re, im, scale, theta):
    block = HarmonicBlock(3, 5.0, 0.01)
    block.turn(theta)
    block.adapt(error=error, response=complex(re, im), scale=scale, rate_1_s=0.8, dt_s=0.005)
    block.limit(1.0)
    assert math.isfinite(block.output(1.0))
    assert abs(block.output(1.0)) <= 0.01 * (1 + 1e-9)


@settings(deadline=None)
@given(ratio=st.floats(0.01, 0.99), size=st.floats(1e-6, 1e3), angle=st.floats(-3.1, 3.1))
def test_projection_keeps_the_direction(ratio, size, angle):
    block = HarmonicBlock(1, 5.0, 1e9)
    block.weight = cmath.rect(size, angle)
    block.scale_weights(ratio)
    assert abs(block.weight) == pytest.approx(ratio * size)
    assert cmath.phase(block.weight) == pytest.approx(angle, abs=1e-9)
    block.amp_limit = 0.1 * ratio * size
    block.limit(1.0)
    assert abs(block.weight) == pytest.approx(0.1 * ratio * size)
    assert cmath.phase(block.weight) == pytest.approx(angle, abs=1e-9)
    assert block.clamped


def test_reset_forgets():
    block = HarmonicBlock(1, 5.0, 1.0)
    block.weight = 1j
    block.reset()
    assert block.output(1.0) == 0.0


def test_long_memory_of_the_response_bounds_the_rate():
    block = HarmonicBlock(1, 4.0, 1.0)
    assert block.adaptation_rate(0.01) == pytest.approx(1.0)
    assert block.adaptation_rate(3.0) == pytest.approx(0.1)
