import numpy as np
import pytest
from scipy.signal import lfilter

from sim_plant.refine.noise.innovations import (
    band_power,
    filter_taps,
    first_judged,
    noise_model,
    periodogram,
    rounding_step,
    whitening_filter,
)
from tests.each_case import each_case


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


def white_model(channels, words=()):
    rng = np.random.default_rng(9)
    runs = rng.standard_normal((2, channels, 9000))
    return noise_model(runs, 1000, np.zeros(channels), words)


@each_case(("step_s", "taps"), [(0.02, 24), (0.01, 24), (0.005, 48), (0.001, 240)])
def test_the_filter_spans_as_much_time_at_shorter_sample_times(step_s, taps):
    assert filter_taps(step_s) == taps


def test_noise_at_1_ms_that_remembers_0_3_s_is_white():
    """White noise of unit size and 0.3 of it in a first-order filter of 0.3 s."""
    step_s, samples = 0.001, 40_000
    pole = np.exp(-step_s / 0.3)

    def runs(count, seed):
        rng = np.random.default_rng(seed)
        fresh = rng.standard_normal((count, 5000 + samples))
        slow = lfilter([np.sqrt(1.0 - pole**2)], [1.0, -pole], fresh)[:, 5000:]
        return rng.standard_normal((count, samples)) + 0.3 * slow

    declared = runs(12, 1)[:, None]
    model = noise_model(declared, 0, np.zeros(1), order=filter_taps(step_s))
    power = np.mean([periodogram(model.whiten(run[None])[0]) for run in runs(20, 2)], axis=0)
    at_Hz = np.fft.rfftfreq(samples, step_s)
    for low_Hz, high_Hz in ((0.4, 0.8), (0.8, 2.0), (2.0, 5.0), (5.0, 20.0)):
        band = power[(at_Hz > low_Hz) & (at_Hz < high_Hz)]
        assert band.mean() == pytest.approx(1.0, abs=0.25)


def test_noise_louder_than_declared_is_noticed_and_a_low_line_is_not_noise():
    rng = np.random.default_rng(4)
    data = rng.standard_normal((3, 9000))
    data[1] *= 2.0
    data[2] += 5.0 * np.sin(0.05 * np.arange(9000))
    power = np.mean(white_model(3).adjusted_to(data).whiten(data) ** 2, axis=1)
    assert power[:2] == pytest.approx([1.0, 1.0], abs=0.06)
    assert power[2] > 10.0  # 13.5 were the line left whole


def test_colour_within_half_of_the_declared_power_is_noise():
    rng = np.random.default_rng(5)
    slow = lfilter([0.18], [1.0, -0.7], rng.standard_normal(9000))
    data = (0.95 * rng.standard_normal(9000) + slow)[None]
    adjusted_to = white_model(1).adjusted_to(data)
    np.testing.assert_allclose(band_power(adjusted_to.whiten(data)[0]), 1.0, atol=0.15)


def test_much_more_power_in_one_band_stays_to_be_explained():
    rng = np.random.default_rng(6)
    gusts = lfilter([0.1], [1.0, -0.95], rng.standard_normal(9000))
    data = (rng.standard_normal(9000) + 2.0 * gusts)[None]
    power = band_power(white_model(1).adjusted_to(data).whiten(data)[0])
    assert power[0] > 1.5
    assert power[-1] == pytest.approx(1.0, abs=0.1)


def test_a_word_that_late_scans_break_up_is_taken_as_white():
    step, speed = 1.0, 0.31
    even = speed * np.arange(9000.0)
    late = even + 3.0 * np.random.default_rng(7).uniform(size=9000)
    sawtooth, broken = (np.floor(x / step + 0.5) * step - x for x in (even, late))
    runs = np.stack([sawtooth, np.roll(sawtooth, 37)])[:, None]
    model = noise_model(runs, 1000, np.zeros(1), [True])
    assert model.sd[0] < 0.5 * model.floor[0]  # a plain sawtooth is foretold
    white = model.adjusted_to(broken[None]).whiten(broken[None])[0]
    assert white.std() == pytest.approx(1.0, abs=0.1)
    assert not model.analogue[0] or model.analogue.all()


def test_lines_are_sought_beside_words_in_other_channels_only():
    assert white_model(3, [False, True, False]).analogue.tolist() == [True, False, True]


def test_a_coarse_word_counts_by_its_quantum():
    model = noise_model(np.zeros((1, 1, 400)), 100, np.array([1e-5]))
    assert model.floor[0] == pytest.approx(1e-5 / np.sqrt(12.0))


@each_case("word", [1e-5, 2e-5, 3e-5, 4e-5, 7e-5, 2.3e-5, 0.5e-5])
def test_a_reading_that_is_rounded_twice_has_the_error_of_both(word):
    own = 1e-5
    values = np.random.default_rng(4).uniform(0.1, 0.2, 400_000)
    counts = np.rint(values / own) * own / max(word, own)
    ties = np.abs(counts - np.floor(counts) - 0.5) < 1e-6
    nearest = np.where(ties, np.floor(counts) + (np.arange(counts.size) % 2), np.rint(counts))
    error = nearest * max(word, own) - values
    assert rounding_step(own, word) / np.sqrt(12.0) == pytest.approx(np.std(error), rel=0.02)


def test_short_records_are_judged_after_a_quarter():
    assert first_judged(8000, 0.01) == 2000
    assert first_judged(1000, 0.01) == 250
