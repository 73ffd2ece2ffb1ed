import numpy as np
import pytest

from sim_plant.refine.model.demand import demand_of, fastest_ramp
from tests.sim_plant.refine.small import formula_twin

STEP_S = 0.01
TIME_S = np.arange(0.0, 60.0, STEP_S)


def test_the_fastest_ramp_counts_whichever_way_it_goes() -> None:
    speed = np.interp(TIME_S, [10.0, 14.0, 30.0, 32.0], [1.0, 1.4, 1.4, 1.0])
    assert fastest_ramp(speed, STEP_S) == pytest.approx(0.2, rel=1e-9)


def test_one_that_accelerates_and_brakes_has_the_rate_of_its_middle() -> None:
    """A cosine over 4 s from 1.0 to 1.4 m/s: its highest rate is 0.2 pi / 4 s."""
    share = np.clip((TIME_S - 20.0) / 4.0, 0.0, 1.0)
    speed = 1.2 - 0.2 * np.cos(np.pi * share)
    assert fastest_ramp(speed, STEP_S) == pytest.approx(0.2 * np.pi / 4.0, rel=0.02)


def test_rounding_of_its_word_takes_nothing_from_a_ramp() -> None:
    speed = np.round(np.interp(TIME_S, [10.0, 14.0], [1.0, 1.8]), 3)
    assert fastest_ramp(speed, STEP_S) == pytest.approx(0.2, rel=0.01)


@pytest.mark.parametrize("speed", [np.full(TIME_S.size, 1.3), 1.0 + 0.5 * (TIME_S > 20.0)])
def test_a_steady_speed_and_a_step_are_no_ramp(speed: np.ndarray) -> None:
    assert fastest_ramp(speed, STEP_S) == 0.0


def test_two_records_ask_for_the_speeds_of_both() -> None:
    """Each runs at a speed of its own, at 10 ms: half of 100 Hz is shown."""
    twins = [formula_twin(None, (), 2000, speed_m_s=speed) for speed in (0.6, 1.4)]
    asked = demand_of(twins)
    assert (asked.slowest_m_s, asked.fastest_m_s) == (0.6, 1.4)
    assert asked.highest_Hz == pytest.approx(50.0)
    assert asked.fastest_ramp_m_s2 == 0.0
