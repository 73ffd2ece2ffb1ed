"""Channels that move together otherwise than their noise does."""

import numpy as np
import pytest

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.search.coherence import least_likely_coupling, least_likely_pair
from tests.sim_plant.refine.small import fit_of, formula_twin, objective_of, white

COUPLED = CRITERIA.search.unexplained.coupled

SAMPLES, STEP_S = 6000, 0.01
NAMES = ("unwind_tension_N", "unwind_speed_rad_s", "rewind_tension_N")


def noise_of_a_loop(seed, samples=SAMPLES):
    """Return three channels: a cell's noise, half of it in a drive's speed, and another cell."""
    rng = np.random.default_rng(seed)
    own = rng.standard_normal((3, samples))
    own[1] = np.sqrt(0.5) * own[0] + np.sqrt(0.5) * own[1]
    return own


def band_limited(seed, low_Hz, high_Hz):
    """Return noise of rms 1 within a band (SAMPLES,)."""
    spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(SAMPLES))
    at = np.fft.rfftfreq(SAMPLES, STEP_S)
    spectrum[(at < low_Hz) | (at > high_Hz)] = 0.0
    values = np.fft.irfft(spectrum, SAMPLES)
    return values / values.std()


def odd(left):
    """Return the least likely pair of what a fit leaves."""
    noise = [noise_of_a_loop(100 + k) for k in range(12)]
    return least_likely_pair(left, noise, NAMES, STEP_S)


@pytest.mark.parametrize("seed", range(20))
def test_noise_that_goes_through_a_loop_as_declared_is_not_odd(seed):
    assert odd(noise_of_a_loop(seed)).score < 0.7 * COUPLED


@pytest.mark.parametrize("shares", [(0.5, -0.5, 0.0), (0.0, 0.5, 0.5)])
def test_a_push_that_reaches_two_channels_is_odd_in_its_band(shares):
    left = noise_of_a_loop(1) + np.outer(shares, band_limited(2, 3.0, 4.5))
    found = odd(left)
    assert found.score > COUPLED
    assert found.channels == tuple(n for n, s in zip(NAMES, shares, strict=True) if s)
    assert (found.from_Hz, found.to_Hz) == pytest.approx((2.5, 5.0))


@pytest.mark.parametrize("faster", [1, 2, pytest.param(10, marks=pytest.mark.long)])
def test_bands_are_frequencies_whatever_the_sample_rate(faster):
    """A push at 0.3 to 0.6 Hz is that of tolerances, at 3 to 4.5 Hz it is odd."""
    samples, step_s = faster * SAMPLES, STEP_S / faster
    at_Hz = np.fft.rfftfreq(samples, step_s)

    def pushed(low_Hz, high_Hz):
        rng = np.random.default_rng(2)
        spectrum = np.fft.rfft(rng.standard_normal(samples))
        spectrum[(at_Hz < low_Hz) | (at_Hz > high_Hz)] = 0.0
        push = np.fft.irfft(spectrum, samples)
        left = noise_of_a_loop(1, samples) + np.outer((0.5, -0.5, 0.0), push / push.std())
        noise = [noise_of_a_loop(100 + k, samples) for k in range(12)]
        return least_likely_pair(left, noise, NAMES, step_s)

    found = pushed(3.0, 4.5)
    assert found.score > COUPLED
    assert (found.from_Hz, found.to_Hz) == (2.5, 5.0)
    assert pushed(0.3, 0.6).score < COUPLED


def test_channels_that_no_longer_move_together_are_odd_as_well():
    left = noise_of_a_loop(1)
    left[1] = np.random.default_rng(3).standard_normal(SAMPLES)
    found = odd(left)
    assert found.score > COUPLED
    assert found.channels == NAMES[:2]


def test_noise_of_one_channel_alone_is_not_odd_however_loud():
    left = noise_of_a_loop(1)
    left[2] += 2.0 * band_limited(2, 2.0, 10.0)
    assert odd(left).score < 0.7 * COUPLED


@pytest.mark.parametrize(("second", "counts"), [(NAMES[1], True), ("unwind_angle_rad", False)])
def test_a_coarse_word_does_not_count(second, counts):
    """The push reaches two channels; as a word the second says nothing."""
    channels = (NAMES[0], second, NAMES[2])
    twin = formula_twin(lambda _: np.zeros((3, SAMPLES)), channels, SAMPLES)
    objective = objective_of(twin, white((3, SAMPLES)))
    push = np.outer((0.5, -0.5, 0.0), band_limited(2, 3.0, 4.5))
    left = objective.whitening.vector([white((3, SAMPLES), 2) + push])
    found = least_likely_coupling(objective, fit_of(residual=left))
    assert (found.score > COUPLED) is counts


def test_a_record_too_short_for_its_bands_claims_nothing():
    left = noise_of_a_loop(1, samples=200)
    assert odd(left).score < 0.7 * COUPLED
