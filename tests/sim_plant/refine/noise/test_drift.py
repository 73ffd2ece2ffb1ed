import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from sim_plant.refine.noise.drift import (
    drift_standard_deviations,
    drift_whitened,
    octaves,
    slow_cosines,
    slow_terms,
)
from sim_plant.refine.noise.innovations import noise_model, periodogram
from tests.each_case import each_case

SAMPLES, STEP_S = 4000, 0.01
SLOW = 32  # of 40 s
EDGES = (0, 1, 2, 4, 8, 16, 32)
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
    assert slow_cosines(values, SLOW) == pytest.approx(values @ cosines(), abs=1e-12)
    assert cosines().T @ cosines() == pytest.approx(np.eye(SLOW), abs=1e-12)


def test_drift_is_brought_to_unit_size_along_every_cosine_and_nowhere_else():
    values = np.random.default_rng(1).standard_normal((2, SAMPLES))
    sd = np.linspace(1.0, 9.0, 2 * SLOW).reshape(2, SLOW)
    left = drift_whitened(values, sd)
    assert left @ cosines() == pytest.approx(values @ cosines() / sd, abs=1e-12)
    rest = np.eye(SAMPLES)[:, :50] - cosines() @ cosines().T[:, :50]
    assert left @ rest == pytest.approx(values @ rest, abs=1e-12)


def test_white_noise_has_unit_terms_and_a_slow_part_is_seen_at_its_size():
    found = drift_standard_deviations(wandering(200, 1), SLOW)
    # spectrum of the slow part at m half turns a record: SHARE (1 - a^2) / |1 - a e^(-i w)|^2
    w = np.pi * np.arange(SLOW) / SAMPLES
    shape = SHARE * (1 - POLE**2) / np.abs(1 - POLE * np.exp(-1j * w)) ** 2
    expected = [np.sqrt(1 + shape[a:b].mean()) for a, b in itertools.pairwise(EDGES)]
    assert found[0] == pytest.approx(1.0, abs=0.12)
    assert [found[1, a] for a in EDGES[:-1]] == pytest.approx(expected, rel=0.15)
    assert expected[0] > 2.2


def test_a_steady_difference_is_worth_what_the_wander_leaves_of_it():
    sd = drift_standard_deviations(wandering(200, 1), SLOW)
    fresh = np.stack([drift_whitened(x, sd) for x in wandering(100, 2)])
    mean = fresh.mean(axis=2) * np.sqrt(SAMPLES)
    assert np.std(mean, axis=0) == pytest.approx([1.0, 1.0], abs=0.25)
    assert slow_cosines(fresh, SLOW).var(axis=(0, 2)) == pytest.approx([1.0, 1.0], abs=0.1)


def test_what_is_faster_than_the_slow_terms_is_left_alone():
    sd = np.full((1, SLOW), 5.0)
    fast = np.cos(np.pi * 2 * SLOW * (np.arange(SAMPLES) + 0.5) / SAMPLES)[None]
    assert drift_whitened(fast, sd) == pytest.approx(fast, abs=1e-9)


@each_case(("judged_s", "terms"), [(15.0, 32), (40.0, 32), (60.0, 32), (100.0, 64), (580.0, 448)])
def test_cosines_are_as_many_as_before_to_80_s_and_near_0_4_Hz_in_long_records(judged_s, terms):
    """Cosine m is m / (2 T) Hz: 0.8 more of them a second end at 0.4 Hz."""
    samples = round(judged_s / STEP_S)
    assert slow_terms(samples, STEP_S) == terms
    assert slow_terms(samples // 2, 2.0 * STEP_S) == terms


@pytest.mark.parametrize(
    ("terms", "edges"), [(32, EDGES), (47, (*EDGES[:-1], 47)), (48, (*EDGES, 48))]
)
def test_groups_are_octaves_the_last_of_half_an_octave_at_least(terms, edges):
    assert octaves(terms) == edges


def test_ten_minutes_of_noise_that_drifts_for_seconds_are_white_above_0_03_Hz_too():
    """White noise of unit size, and 0.3 of it in drift of 3 s, as seeded runs know it."""
    samples, pole = 58_000, np.exp(-STEP_S / 3.0)

    def drifting(runs, seed):
        rng = np.random.default_rng(seed)
        fresh = rng.standard_normal((runs, 2000 + samples))
        slow = lfilter([np.sqrt(1.0 - pole**2)], [1.0, -pole], fresh)[:, 2000:]
        return (rng.standard_normal((runs, samples)) + 0.3 * slow)[:, None]

    model = noise_model(drifting(12, 1), 0, np.zeros(1))
    whitened = np.stack([model.whiten(run) for run in drifting(12, 1)])
    sd = drift_standard_deviations(whitened, slow_terms(samples, STEP_S))
    model = replace(model, slow=sd)
    power = np.mean([periodogram(model.whiten(run)[0]) for run in drifting(12, 2)], axis=0)
    at_Hz = np.fft.rfftfreq(samples, STEP_S)
    for low_Hz, high_Hz in ((0.005, 0.03), (0.03, 0.1), (0.1, 0.2)):
        band = power[(at_Hz > low_Hz) & (at_Hz < high_Hz)]
        assert band.mean() == pytest.approx(1.0, abs=0.3)
