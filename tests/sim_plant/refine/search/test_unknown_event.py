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
