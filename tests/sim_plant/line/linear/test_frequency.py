"""The kernel's closed loop against the linear model that is assembled from the declaration."""

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.line.linear.frequency import hold_factor, response
from tests.sim_plant.line.lines import FPM_M_S, declared, exact_line

# 15 lines of a 20 s period, 0.2 to 8 Hz
FREQUENCIES_Hz = np.round(np.geomspace(0.2, 8.0, 15) * 20.0) / 20.0
AMPLITUDE_M_S = 2e-4


def measured(drive: str, channel: str, speed_m_s: float):
    """P at FREQUENCIES_Hz from a multisine of 20 s period, in its second period."""
    line = exact_line(declared("euclid"), speed_m_s=speed_m_s)
    t = np.arange(8000) * line.sample_time_s
    correction = np.zeros_like(t)
    for k, frequency in enumerate(FREQUENCIES_Hz):
        phase = np.pi * k * k / FREQUENCIES_Hz.size  # Schroeder: a low peak
        correction += AMPLITUDE_M_S * np.cos(2.0 * np.pi * frequency * t + phase)
    rows = line.simulate(np.full(t.size, speed_m_s), np.full(t.size, 88.9644), {drive: correction})
    lock_in = np.exp(-2j * np.pi * np.outer(FREQUENCIES_Hz, t[4000:]))
    return (lock_in @ rows[channel][4000:]) / (lock_in @ correction[4000:])


@pytest.mark.parametrize(
    ("drive", "channel", "speed_FPM"),
    [
        ("unwind", "unwind_tension_N", 200),
        ("unwind", "unwind_tension_N", 100),
        ("swrap_follower", "pullroll_tension_N", 200),
        ("swrap_follower", "swrap_follower_speed_m_s", 200),
    ],
)
@pytest.mark.sweep(every=2)
def test_simulated_response_matches_the_linear_model_at_15_frequencies(drive, channel, speed_FPM):
    speed = speed_FPM * FPM_M_S
    model = response(declared("euclid"), drive, channel, FREQUENCIES_Hz, speed)
    ratio = measured(drive, channel, speed) / model
    assert np.unique(FREQUENCIES_Hz).size == 15
    assert np.max(np.abs(np.abs(ratio) - 1.0)) < 0.02
    assert np.max(np.abs(np.degrees(np.angle(ratio)))) < 2.0


def test_unwind_phase_is_that_of_an_independent_simulator():
    """Phase of -P at 1..5 turns per second-of-roll, 100 FPM, 8 in: design figures, own line."""
    speed = 100 * FPM_M_S
    turn_Hz = speed / (2.0 * np.pi * 0.2032)
    P = response(
        declared("euclid"), "unwind", "unwind_tension_N", turn_Hz * np.arange(1, 6), speed
    )
    assert np.degrees(np.angle(-P)) == pytest.approx([37, -21, -45, -69, -97], abs=2.0)


def test_tension_reference_is_reached_at_low_frequency_so_corrections_fade():
    """An integrating tension loop leaves |P| falling with frequency towards zero."""
    low = response(declared("euclid"), "unwind", "unwind_tension_N", np.array([1e-3, 1e-2]), 1.016)
    assert abs(low[1]) / abs(low[0]) == pytest.approx(10.0, rel=0.05)


def test_hold_factor_is_the_sampled_half_period_delay():
    s = 2j * np.pi * 3.0
    stair = np.exp(-s * 1e-3 * np.arange(5)).mean()
    assert hold_factor(s, 0.005, 0.001) == pytest.approx(stair, rel=1e-12)
    assert hold_factor(s, 0.001, 0.001) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("drive", "channel", "said"),
    [
        ("R9", "unwind_tension_N", "'R9' has no drive"),
        ("unwind", "unwind_radius_m", "no tension, speed or travel"),
        ("unwind", "nothing", "no tension, speed or travel"),
    ],
)
def test_refuses_what_it_cannot_answer(drive, channel, said):
    with pytest.raises(PlantError, match=said):
        response(declared("euclid"), drive, channel, np.array([1.0]), 1.016)
