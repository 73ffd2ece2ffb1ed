import numpy as np
import pytest

from sim_plant.refine.records.recorded_only import filled

STEP_S = 0.005
FROM_S = 40.0
TAKEN_S = np.arange(400) * STEP_S
RISING = 2.0 + 3.0 * TAKEN_S


def without(rows):
    values = RISING.copy()
    values[rows] = np.nan
    return filled(values, TAKEN_S, TAKEN_S + FROM_S, STEP_S)


def test_what_is_missing_for_four_samples_stands_on_a_straight_line():
    found = without(slice(100, 104))
    assert found.values == pytest.approx(RISING)
    assert found.holes_in(0, 400) == ""


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (slice(100, 106), r"from 40\.49\d? s to 40\.53 s of the run"),
        (slice(0, 20), r"from 40\.00 s to 40\.10 s of the run"),
        (slice(200, 400), r"from 40\.99\d? s to 41\.99\d? s of the run"),
    ],
)
def test_a_longer_hole_is_named_with_its_place(rows, said):
    import re

    assert re.search(said, without(rows).holes_in(0, 400))


def test_a_hole_outside_the_piece_is_none_of_its_business():
    assert without(slice(0, 50)).holes_in(50, 400) == ""


def test_a_reading_that_is_no_number_is_missing():
    values = RISING.copy()
    values[7] = 1e300
    assert filled(values, TAKEN_S, TAKEN_S, STEP_S).values == pytest.approx(RISING)
