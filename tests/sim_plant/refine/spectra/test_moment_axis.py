import numpy as np
import pytest

from sim_plant.refine.spectra.moment_axis import MomentAxis, parts_of, resampled, shifted


def test_a_straight_line_stays_one_at_equal_steps_of_another_coordinate() -> None:
    coordinate = np.array([0.0, 1.0, 3.0, 6.0])
    assert resampled(coordinate[None], coordinate, np.arange(7.0))[0] == pytest.approx(
        np.arange(7)
    )


def test_a_change_is_moved_with_what_lasts_at_its_end() -> None:
    change = np.array([[0.0, 0.0, 1.0, 2.0, 3.0]])
    assert shifted(change, 2).tolist() == [[0.0, 0.0, 0.0, 0.0, 1.0]]
    assert shifted(change, -2).tolist() == [[1.0, 2.0, 3.0, 3.0, 3.0]]
    assert shifted(change, 0).tolist() == change.tolist()


def test_parts_around_given_moments_meet_half_way_and_cover_the_record() -> None:
    grid = np.linspace(2.0, 60.0, 59)
    parts = parts_of(MomentAxis(moments=grid, grid=grid, looked_at=(40.0, 10.0)))
    assert [(p.low, p.middle, p.high) for p in parts] == [(2.0, 10.0, 25.0), (25.0, 40.0, 60.0)]
