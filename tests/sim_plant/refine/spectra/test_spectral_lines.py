import numpy as np
import pytest

from sim_plant.refine.spectra.spectral_lines import spectral_lines, speed_weights

STEP_S = 0.01
TIME_S = np.arange(6000) * STEP_S
SPEED = 1.0 + 0.4 * (TIME_S > 25.0) + 0.1 * np.sin(0.3 * TIME_S)
TRAVEL = np.cumsum(SPEED) * STEP_S


def noise(channels=3):
    return np.random.default_rng(6).standard_normal((channels, TIME_S.size))


def found(signal, phase, axis):
    return spectral_lines(
        signal, phase, speed_weights(SPEED, 2), axis=axis, highest=10.0, lowest=0.1
    )


def test_a_line_in_travel_is_sharp_in_travel_and_smeared_in_time():
    wave = 2.0 * np.pi * 4.18 * TRAVEL
    signal = noise() + 0.3 * np.outer([1.0, -0.5, 0.2], np.cos(wave))
    travel, time = found(signal, TRAVEL, "travel"), found(signal, TIME_S, "time")
    at, chi2_reduction = travel.peak
    assert at == pytest.approx(4.18, rel=0.002)
    expected = 0.3**2 * 0.5 * 1.29 * TIME_S.size
    assert chi2_reduction == pytest.approx(expected, rel=0.25)
    assert time.peak[1] < 0.5 * chi2_reduction


def test_a_line_in_time_is_found_in_hertz():
    signal = noise() + 0.3 * np.cos(2.0 * np.pi * 3.4 * TIME_S)
    at, chi2_reduction = found(signal, TIME_S, "time").peak
    assert at == pytest.approx(3.4, abs=0.02)
    assert found(signal, TRAVEL, "travel").peak[1] < 0.5 * chi2_reduction


def test_noise_has_the_degrees_it_says():
    spectrum = found(noise(), TIME_S, "time")
    assert spectrum.degrees == 12
    assert float(spectrum.chi2_reduction.mean()) == pytest.approx(12.0, rel=0.1)


def test_one_speed_leaves_one_weight():
    assert speed_weights(np.full(100, 2.0)).shape == (1, 100)
    weights = speed_weights(SPEED)
    np.testing.assert_allclose(weights @ weights.T / SPEED.size, np.eye(3), atol=1e-9)
