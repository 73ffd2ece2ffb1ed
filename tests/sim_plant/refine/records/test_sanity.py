from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.refine.records.sanity import (
    count_sizes_seen,
    even_grid,
    oddities,
    spikes_in,
    unwrapped,
)

HERE = Path("record.csv")


def test_uneven_stamps_are_put_on_a_grid_and_said():
    rng = np.random.default_rng(1)
    time_s = np.arange(500) * 0.01 + rng.uniform(-0.002, 0.002, 500)
    step_s, columns, said = even_grid(HERE, time_s, {"x": 3.0 * time_s})
    grid = time_s[0] + step_s * np.arange(500)
    np.testing.assert_allclose(columns["x"][5:-5], 3.0 * grid[5:-5], atol=1e-9)
    assert "uneven" in said[0]


def test_one_misplaced_stamp_is_no_gap():
    time_s = np.arange(500) * 0.01
    time_s[100] = time_s[101]
    _, _, said = even_grid(HERE, time_s, {"x": time_s.copy()})
    assert said[0] == "1 misplaced stamp"


def test_a_missing_row_is_a_gap():
    time_s = np.delete(np.arange(500) * 0.01, 100)
    with pytest.raises(PlantError, match="first after line 101"):
        even_grid(HERE, time_s, {"x": time_s})


def test_spikes_are_counted_and_noise_is_not():
    values = np.random.default_rng(2).standard_normal(2000)
    assert spikes_in(values) == 0
    values[[300, 900, 1500]] += 60.0
    assert spikes_in(values) == 3


def test_the_ends_of_a_ramp_are_no_spikes():
    """An angle that goes on and on: a median of fewer neighbours is off at both ends."""
    assert spikes_in(6.0 * np.arange(2000) * 0.01) == 0


def test_a_stepped_reference_is_no_coarse_reading():
    values = np.where(np.arange(2000) < 1500, 88.96, 95.0)
    assert oddities({"tension_ref_N": values}) == []
    said = oddities({"unwind_tension_N": np.round(values + np.sin(np.arange(2000)), 1)})
    assert said[0] == "unwind_tension_N is read in steps of 0.1 N"


def test_one_count_of_a_word_is_no_spike_where_the_count_is_known():
    """A speed that stands on the edge of a count, and a hole that was filled in between."""
    values = np.full(2000, 0.85)
    values[200::100] += 0.001
    values[[700, 1300]] += 0.004
    counts = count_sizes_seen({"line_speed_m_s": values}, {"line_speed_m_s": 0.001})
    values[50:53] = 0.85 + 0.001 * np.array([0.25, 0.5, 0.75])
    assert oddities({"line_speed_m_s": values}, counts) == [
        "line_speed_m_s is read in steps of 0.001 m/s",
        "line_speed_m_s has 2 spikes",
    ]


def test_a_sensor_may_be_coarser_than_its_word():
    read = {"a_N": np.round(20.0 * np.sin(np.arange(2000.0)) / 0.05) * 0.05, "b_N": np.zeros(9)}
    counts = count_sizes_seen(read, {"a_N": 0.001, "b_N": 0.01})
    assert counts == {"a_N": pytest.approx(0.05), "b_N": 0.01}


def test_steps_and_stops_are_said():
    time_s = np.arange(2000) * 0.01
    said = " ".join(
        oddities(
            {
                "coarse": np.round(np.sin(time_s), 1),
                "still": np.full(2000, 3.0),
                "clipped": np.minimum(np.sin(time_s) + 1e-6 * time_s, 0.5),
            }
        )
    )
    assert "coarse is read in steps of 0.1" in said
    assert "still stands still at 3" in said
    assert "clipped sits at its top 0.5" in said


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_an_angle_that_starts_over_is_unwrapped_and_said(way):
    angle = way * (0.3 + 0.07 * np.arange(500))
    found, said = unwrapped({"x_angle_rad": np.mod(angle, 2.0 * np.pi), "y_N": angle})
    np.testing.assert_allclose(np.diff(found["x_angle_rad"]), np.diff(angle), atol=1e-9)
    assert found["y_N"] is angle
    assert said == ["x_angle_rad starts over 5 times: unwrapped"]


def test_an_angle_that_goes_on_stays_as_it_is():
    angle = 0.07 * np.arange(500)
    angle[100:] -= 0.2  # a jerk is no start over
    found, said = unwrapped({"x_angle_rad": angle})
    assert found["x_angle_rad"] is angle
    assert said == []
