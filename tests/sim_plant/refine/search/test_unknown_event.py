import numpy as np
import pytest

from sim_plant.refine.search.unknown_event import beginning, zone_of
from tests.sim_plant.effects.running import euclid

STEP_S = 0.01


def power(seed: int, samples: int = 6000) -> np.ndarray:
    """Squares of white noise of 9 channels."""
    return np.random.default_rng(seed).standard_normal((9, samples)) ** 2


@pytest.mark.parametrize("seed", range(12))
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
