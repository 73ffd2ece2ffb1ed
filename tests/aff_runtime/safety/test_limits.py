from __future__ import annotations

from math import cos, inf, nan, pi, sin

import numpy as np
import pytest

from aff_runtime.base.signals import ActuatorStep
from aff_runtime.safety.limits import SLEW_SHARE, Limiter, makes_sense
from aff_runtime.safety.params import ActuatorLimits
from tests.each_case import each_case

DT_S = 0.005
FADE_S = 0.150
BOUNDS = ActuatorLimits(name="unwind", limit=0.05, slew_limit=2.0)


def sine(amplitude: float, frequency_Hz: float, k: int) -> ActuatorStep:
    omega = 2 * pi * frequency_Hz
    return ActuatorStep(
        value=amplitude * sin(omega * k * DT_S), peak_bound=amplitude, slew_bound=omega * amplitude
    )


def run(bounds: ActuatorLimits, amplitude: float, frequency_Hz: float, ticks: int) -> np.ndarray:
    limiter = Limiter(bounds, FADE_S)
    out = np.empty(ticks)
    for k in range(ticks):
        wish = sine(amplitude, frequency_Hz, k)
        assert makes_sense(wish)
        limiter.step(wish, 1.0, DT_S)
        out[k] = limiter.output
    return out


def test_inside_the_limits_the_wish_goes_out_unchanged() -> None:
    out = run(BOUNDS, 0.04, 1.0, 400)
    expected = [0.04 * sin(2 * pi * k * DT_S) for k in range(400)]
    assert out == pytest.approx(expected)


@pytest.mark.parametrize(
    ("amplitude", "frequency_Hz", "bounds"),
    [
        (0.20, 1.0, BOUNDS),  # four times the limit
        (0.04, 5.0, ActuatorLimits(name="slow", limit=0.05, slew_limit=0.3)),  # by slew
        (5.0, 2.0, ActuatorLimits(name="tight", limit=0.05, slew_limit=0.2)),  # both, grossly
    ],
)
def test_a_limited_sine_is_a_smaller_sine_without_harmonics(
    amplitude: float, frequency_Hz: float, bounds: ActuatorLimits
) -> None:
    out = run(bounds, amplitude, frequency_Hz, 4400)[400:]  # 20 s: whole turns of each frequency
    spectrum = np.abs(np.fft.rfft(out)) / (len(out) / 2)
    fundamental = round(frequency_Hz * 20)
    omega = 2 * pi * frequency_Hz
    expected = min(bounds.limit, SLEW_SHARE * bounds.slew_limit / omega)
    assert spectrum[fundamental] == pytest.approx(expected, rel=1e-3)
    others = np.delete(spectrum, fundamental)
    assert 20 * np.log10(others.max() / spectrum[fundamental]) < -60


def test_the_clipped_sine_that_this_avoids_would_fail_the_same_measure() -> None:
    t = np.arange(4000) * DT_S
    clipped = np.clip(0.20 * np.sin(2 * pi * t), -0.05, 0.05)
    spectrum = np.abs(np.fft.rfft(clipped))
    assert 20 * np.log10(spectrum[60] / spectrum[20]) > -20


def test_the_scale_follows_without_a_step_and_reports_saturation() -> None:
    limiter = Limiter(BOUNDS, FADE_S)
    before = limiter.scale
    for k in range(400):
        limiter.step(sine(0.1 if 100 <= k < 200 else 0.01, 1.0, k), 1.0, DT_S)
        assert abs(limiter.scale - before) <= 0.05 + 1e-12
        before = limiter.scale
        if k == 199:
            assert limiter.scale == pytest.approx(0.5)
            assert limiter.wanted_scale == pytest.approx(0.5)
            assert limiter.saturated
    assert limiter.scale == pytest.approx(1.0)
    assert not limiter.saturated


def test_a_law_that_projects_its_weights_every_tick_does_not_collapse() -> None:
    limiter = Limiter(BOUNDS, FADE_S)
    amplitude = 0.2
    for k in range(2000):
        limiter.step(sine(amplitude, 1.0, k), 1.0, DT_S)
        amplitude *= limiter.wanted_scale
    assert amplitude == pytest.approx(BOUNDS.limit)
    assert limiter.scale == pytest.approx(1.0)


def test_a_bound_smaller_than_the_value_does_not_help_a_law_past_the_limit() -> None:
    limiter = Limiter(BOUNDS, FADE_S)
    out = []
    for k in range(1000):
        liar = ActuatorStep(value=0.3 * cos(k * 0.03), peak_bound=0.0, slew_bound=0.0)
        limiter.step(liar, 1.0, DT_S)
        out.append(abs(limiter.output))
    assert max(out) <= BOUNDS.limit
    at_the_limit = sum(value > 0.999 * BOUNDS.limit for value in out[200:]) / 800
    assert at_the_limit < 0.6  # clipped it would be 89 % of the time


@each_case(
    "bad",
    [
        ActuatorStep(value=nan, peak_bound=1.0, slew_bound=1.0),
        ActuatorStep(value=inf, peak_bound=inf, slew_bound=1.0),
        ActuatorStep(value=0.01, peak_bound=nan, slew_bound=1.0),
        ActuatorStep(value=0.01, peak_bound=1.0, slew_bound=inf),
        ActuatorStep(value=0.01, peak_bound=-1.0, slew_bound=1.0),
    ],
)
def test_nonsense_is_recognised(bad: ActuatorStep) -> None:
    assert not makes_sense(bad)


def test_without_a_wish_the_output_goes_to_zero_by_slew() -> None:
    limiter = Limiter(BOUNDS, FADE_S)
    for _ in range(100):
        limiter.step(ActuatorStep(value=0.05, peak_bound=0.05, slew_bound=0.1), 1.0, DT_S)
    assert limiter.output == pytest.approx(0.05)
    outputs = []
    for _ in range(6):
        limiter.step(None, 1.0, DT_S)
        outputs.append(limiter.output)
    assert outputs == pytest.approx([0.04, 0.03, 0.02, 0.01, 0.0, 0.0])


def test_a_jump_of_the_wish_leaves_at_the_slew_limit() -> None:
    limiter = Limiter(BOUNDS, FADE_S)
    limiter.step(ActuatorStep(value=0.05, peak_bound=0.05, slew_bound=0.1), 1.0, DT_S)
    assert limiter.output == pytest.approx(2.0 * DT_S)


def test_a_smaller_limit_takes_hold_within_one_fade_without_a_step() -> None:
    limiter = Limiter(BOUNDS, FADE_S)
    wish = ActuatorStep(value=0.05, peak_bound=0.05, slew_bound=0.1)
    for _ in range(100):
        limiter.step(wish, 1.0, DT_S)
    limiter.adopt(ActuatorLimits(name="unwind", limit=0.01, slew_limit=2.0), FADE_S)
    before = limiter.output
    for _ in range(30):
        limiter.step(wish, 1.0, DT_S)
        assert abs(limiter.output - before) <= 0.05 / FADE_S * DT_S + 1e-12
        before = limiter.output
    assert limiter.limit == pytest.approx(0.01)
    assert abs(limiter.output) <= 0.01
