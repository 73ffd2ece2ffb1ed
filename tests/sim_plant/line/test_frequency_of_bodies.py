"""Small signals of a line with dancer, oven and accumulator: kernel beside the linear model."""

from functools import cache

import numpy as np
import pytest

from sim_plant.line.linear.frequency import response
from tests.sim_plant.line.bodies import SPEED_M_S, TENSION_N, coater, exact_coater

FREQUENCIES_Hz = np.array([0.05, 0.1, 0.2, 0.35, 0.6, 1.0, 1.6, 2.5, 4.0, 6.0, 8.0])
PERIOD_S, AMPLITUDE_M_S = 20.0, 1e-4
PLACES = {
    "unwind": ["dancer_position_m", "infeed_tension_N", "unwind_speed_rad_s"],
    "infeed": ["oven_tension_N", "pullroll_tension_N", "dancer_position_m"],
    "pull_roll": ["rewind_tension_N", "pullroll_tension_N", "accumulator_position_m"],
}


BETWEEN = "infeed"
"""Of three drives; quick are the first and the last, between which all bodies are."""


@cache
def run_of(drive):
    """The drive under a multisine of 20 s: the second period of every channel."""
    line = exact_coater(settle_s=5.0)
    t = np.arange(round(2 * PERIOD_S / line.sample_time_s)) * line.sample_time_s
    correction = np.zeros_like(t)
    for k, frequency in enumerate(FREQUENCIES_Hz):
        phase = np.pi * k * k / FREQUENCIES_Hz.size
        correction += AMPLITUDE_M_S * np.cos(2.0 * np.pi * frequency * t + phase)
    rows = line.simulate(
        np.full(t.size, SPEED_M_S), np.full(t.size, TENSION_N), {drive: correction}
    )
    half = t.size // 2
    return t[half:], correction[half:], {k: v[half:] for k, v in rows.items()}


def phasors(values, t):
    """Least-squares phasors beside a cubic.

    Two drives that hold speeds with integrals are springs: the tension between them comes to rest
    with a time constant of 42 s.
    """
    turn = 2.0 * np.pi * np.outer(t, FREQUENCIES_Hz)
    slow = np.vander((t - t.mean()) / PERIOD_S, 4)
    basis = np.hstack((np.cos(turn), -np.sin(turn), slow))
    found = np.linalg.lstsq(basis, values, rcond=None)[0]
    n = FREQUENCIES_Hz.size
    return found[:n] + 1j * found[n : 2 * n]


@pytest.mark.parametrize(
    ("drive", "channel"),
    [
        pytest.param(drive, name, marks=pytest.mark.long if drive == BETWEEN else ())
        for drive, names in PLACES.items()
        for name in names
    ],
)
def test_simulated_response_matches_the_linear_model(drive, channel):
    t, correction, rows = run_of(drive)
    measured = phasors(rows["true_" + channel], t) / phasors(correction, t)
    model = response(coater(), drive, channel, FREQUENCIES_Hz, SPEED_M_S)
    largest = np.abs(model).max()
    felt = np.abs(model) > 1e-3 * largest
    assert felt.sum() >= 8
    ratio = (measured / model)[felt]
    assert np.max(np.abs(np.abs(ratio) - 1.0)) < 0.01  # 2e-4 below 2 Hz
    assert np.max(np.abs(np.degrees(np.angle(ratio)))) < 0.5
