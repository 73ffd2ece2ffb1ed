import numpy as np
import pytest
from scipy.signal import lfilter

from sim_plant.refine.noise.innovations import noise_model
from sim_plant.refine.search.unknown_event import beginning, zone_of
from tests.each_case import each_case
from tests.sim_plant.effects.running import euclid

STEP_S = 0.01


def power(seed: int, samples: int = 6000) -> np.ndarray:
    """Squares of white noise of 9 channels."""
    return np.random.default_rng(seed).standard_normal((9, samples)) ** 2


@each_case("seed", range(12))
def test_noise_has_no_beginning(seed: int) -> None:
    assert beginning(power(seed), STEP_S) is None


@pytest.mark.parametrize("share", [3e-4, 1e-3])
@pytest.mark.parametrize("channels", [3, 9])
@pytest.mark.parametrize("seed", range(15))
def test_spikes_in_noise_are_no_beginning(seed: int, channels: int, share: float) -> None:
    """Of 15 to 20 standard deviations, in noise whose level is taken with them."""
    rng = np.random.default_rng(seed)
    left = rng.standard_normal((channels, 4000))
    struck = rng.random(left.shape) < share
    left[struck] += rng.uniform(15.0, 20.0, struck.sum()) * rng.choice([-1.0, 1.0], struck.sum())
    assert beginning((left / left.std(axis=1, keepdims=True)) ** 2, STEP_S) is None


def whitened(seed: int, channels: int, spike_sd: float, gain: float = 1.0) -> np.ndarray:
    """Squares of whitened noise that rings, with a spike at 12 to 25 s and louder from 32 s on."""
    rng = np.random.default_rng(seed)

    def noise() -> np.ndarray:
        return lfilter([1.0], [1.0, -1.5, 0.7], rng.standard_normal((channels, 4500)))[:, 500:]

    model = noise_model(np.stack([noise() for _ in range(3)]), 0, np.zeros(channels))
    left = noise()
    left[rng.integers(channels), rng.integers(1200, 2500)] += spike_sd * model.floor[0]
    power = model.whiten(left) ** 2
    power[0, 3200:] *= gain
    return power


@pytest.mark.parametrize("spike_sd", [20.0, 1000.0])
@pytest.mark.parametrize("channels", [3, 6])
@pytest.mark.parametrize("seed", range(15))
def test_a_spike_that_the_filter_draws_out_is_no_beginning(seed, channels, spike_sd) -> None:
    """Of 1000 standard deviations it is more than five in 25 samples of its channel."""
    assert beginning(whitened(seed, channels, spike_sd), STEP_S) is None


@each_case("seed", range(15))
def test_a_spike_that_the_filter_draws_out_hides_no_beginning(seed: int) -> None:
    assert beginning(whitened(seed, 6, 1000.0, 12.0), STEP_S) == pytest.approx(3200, abs=25)


@each_case("seed", range(8))
def test_what_is_loud_for_a_second_begins_there(seed: int) -> None:
    loud = power(seed)[:3]
    loud[2, 2503:2603] *= 12.0
    assert beginning(loud, STEP_S) == pytest.approx(2503, abs=15)


def test_a_spike_hides_no_beginning() -> None:
    loud = power(3)
    loud[2, 2503:] *= 6.0
    loud[4, 1200] = 1e6
    assert beginning(loud, STEP_S) == pytest.approx(2503, abs=5)


@pytest.mark.parametrize("onset", [1000, 2503, 4311])
def test_what_grows_loud_begins_there_to_50_ms(onset: int) -> None:
    loud = power(3)
    loud[2, onset:] *= 6.0
    assert beginning(loud, STEP_S) == pytest.approx(onset, abs=5)


def test_what_is_loud_from_the_start_has_no_beginning() -> None:
    assert beginning(4.0 * power(4), STEP_S) is None


def test_bursts_that_come_again_and_again_have_no_beginning() -> None:
    loud = power(5)
    for k in range(30, 6000, 230):
        loud[:, k : k + 60] *= 4.0
    assert beginning(loud, STEP_S) is None


@pytest.mark.parametrize(
    ("channel", "zone"),
    [
        ("r3_tension_N", "unwind_zone"),
        ("pullroll_tension_N", "pull_roll_zone"),
        ("rewind_tension_N", "rewind_zone"),
    ],
)
def test_a_channel_reads_in_the_zone_of_its_roller(channel: str, zone: str) -> None:
    assert zone_of(euclid(), channel) == zone
