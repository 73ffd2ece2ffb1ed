import numpy as np
import pytest
from scipy.signal import lfilter

from sim_plant.refine.noise import first_judged, measured_scale, noise_model, whitening_filter


def coloured(seed, size=20000):
    return lfilter([0.3], [1.0, -1.5, 0.7], np.random.default_rng(seed).standard_normal(size))


def test_whitening_finds_the_recursion_that_made_the_noise():
    taps, sd = whitening_filter(np.stack([coloured(1), coloured(2)]), 4)
    np.testing.assert_allclose(taps, [1.0, -1.5, 0.7, 0.0, 0.0], atol=0.03)
    assert sd == pytest.approx(0.3, rel=0.02)


def test_whitened_noise_is_white_and_of_unit_variance():
    runs = np.stack([coloured(s)[None] for s in (1, 2)])
    model = noise_model(runs, 1000, np.zeros(1))
    white = model.whiten(coloured(3)[None])[0]
    assert white.std() == pytest.approx(1.0, rel=0.03)
    lag = np.array([np.mean(white[k:] * white[:-k]) for k in range(1, 6)])
    assert np.abs(lag).max() < 0.04
    assert model.floor[0] == pytest.approx(runs[:, 0, 1000:].std(), rel=0.02)


def test_noise_louder_than_declared_is_noticed_and_a_low_line_is_not_noise():
    rng = np.random.default_rng(4)
    white = rng.standard_normal((3, 8000))
    white[1] *= 2.0
    white[2] += 5.0 * np.sin(0.05 * np.arange(8000))
    np.testing.assert_allclose(measured_scale(white), [1.0, 2.0, 1.0], rtol=0.06)


def test_a_coarse_word_counts_by_its_quantum():
    model = noise_model(np.zeros((1, 1, 400)), 100, np.array([1e-5]))
    assert model.floor[0] == pytest.approx(1e-5 / np.sqrt(12.0))


def test_short_records_are_judged_after_a_quarter():
    assert first_judged(8000, 0.01) == 2000
    assert first_judged(1000, 0.01) == 250
