import itertools

import numpy as np
import pytest
from scipy.signal import lfilter

from sim_plant.refine.noise.drift import (
    OCTAVES,
    SLOW,
    drift_standard_deviations,
    drift_whitened,
    slow_cosines,
)

SAMPLES = 4000
POLE, SHARE, RUN_IN = 0.98, 0.05, 500  # half a second at 10 ms


def wandering(runs: int, seed: int) -> np.ndarray:
    """White noise of unit size with a slow part in the second channel, (runs, 2, n)."""
    rng = np.random.default_rng(seed)
    white = rng.standard_normal((runs, 2, SAMPLES))
    fresh = rng.standard_normal((runs, RUN_IN + SAMPLES))
    white[:, 1] += lfilter([np.sqrt(SHARE * (1 - POLE**2))], [1, -POLE], fresh)[:, RUN_IN:]
    return white


def cosines():
    """Return the slowest cosines over a record (samples, terms), by their formula."""
    at = np.arange(SAMPLES) + 0.5
    terms = np.cos(np.pi * np.outer(at, np.arange(SLOW)) / SAMPLES) * np.sqrt(2.0 / SAMPLES)
    terms[:, 0] /= np.sqrt(2.0)
    return terms


def test_slow_cosines_are_the_parts_along_orthonormal_cosines():
    values = np.random.default_rng(1).standard_normal((3, SAMPLES))
    assert slow_cosines(values) == pytest.approx(values @ cosines(), abs=1e-12)
    assert cosines().T @ cosines() == pytest.approx(np.eye(SLOW), abs=1e-12)


def test_drift_is_brought_to_unit_size_along_every_cosine_and_nowhere_else():
    values = np.random.default_rng(1).standard_normal((2, SAMPLES))
    sd = np.linspace(1.0, 9.0, 2 * SLOW).reshape(2, SLOW)
    left = drift_whitened(values, sd)
    assert left @ cosines() == pytest.approx(values @ cosines() / sd, abs=1e-12)
    rest = np.eye(SAMPLES)[:, :50] - cosines() @ cosines().T[:, :50]
    assert left @ rest == pytest.approx(values @ rest, abs=1e-12)


def test_white_noise_has_unit_terms_and_a_slow_part_is_seen_at_its_size():
    found = drift_standard_deviations(wandering(200, 1))
    # spectrum of the slow part at m half turns a record: SHARE (1 - a^2) / |1 - a e^(-i w)|^2
    w = np.pi * np.arange(SLOW) / SAMPLES
    shape = SHARE * (1 - POLE**2) / np.abs(1 - POLE * np.exp(-1j * w)) ** 2
    expected = [np.sqrt(1 + shape[a:b].mean()) for a, b in itertools.pairwise(OCTAVES)]
    assert found[0] == pytest.approx(1.0, abs=0.12)
    assert [found[1, a] for a in OCTAVES[:-1]] == pytest.approx(expected, rel=0.15)
    assert expected[0] > 2.2


def test_a_steady_difference_is_worth_what_the_wander_leaves_of_it():
    sd = drift_standard_deviations(wandering(200, 1))
    fresh = np.stack([drift_whitened(x, sd) for x in wandering(100, 2)])
    mean = fresh.mean(axis=2) * np.sqrt(SAMPLES)
    assert np.std(mean, axis=0) == pytest.approx([1.0, 1.0], abs=0.25)
    assert slow_cosines(fresh).var(axis=(0, 2)) == pytest.approx([1.0, 1.0], abs=0.1)


def test_what_is_faster_than_the_slow_terms_is_left_alone():
    sd = np.full((1, SLOW), 5.0)
    fast = np.cos(np.pi * 2 * SLOW * (np.arange(SAMPLES) + 0.5) / SAMPLES)[None]
    assert drift_whitened(fast, sd) == pytest.approx(fast, abs=1e-9)
