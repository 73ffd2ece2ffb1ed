"""One row read as numbers, and the same row as a record of one sample."""

import numpy as np
import pytest

from sim_plant.line.open import make_line
from sim_plant.line.running.channels import channel_value, column_values
from tests.sim_plant.line.lines import declared, with_effect

LINE = make_line(
    with_effect(
        declared("euclid"),
        "encoder_eccentricity",
        "swrap_follower",
        loop_share=1.0,
        eccentricity=2e-3,
        angle_rad=0.4,
    ),
    seed=1,
)


def test_the_line_has_each_way_to_read_a_channel():
    angles = [one for one in LINE.channels if one.theta_body >= 0]
    assert {one.eccentricity != 0.0 for one in angles} == {False, True}
    assert {one.lsb > 0.0 for one in LINE.channels} == {False, True}


@pytest.mark.parametrize("exact", [False, True])
@pytest.mark.parametrize("beside", [0.0, np.inf, -np.inf, np.nan])
def test_a_row_as_numbers_is_the_record_of_it_to_the_last_bit(exact, beside):
    rng = np.random.default_rng(3)
    theta0 = rng.uniform(-40.0, 40.0, LINE.layout.n + LINE.arrays.drives.size)
    for row in rng.uniform(-300.0, 300.0, (40, LINE.log.width)):
        row[::3] += beside
        with np.errstate(invalid="ignore"):
            for channel in LINE.channels:
                seen = channel_value(channel, row.tolist(), theta0.tolist(), exact)
                record = np.ravel(column_values(channel, row[None, :], theta0, exact))
                np.testing.assert_array_equal(seen, record, strict=False)


def test_a_roller_without_a_drive_has_no_number_of_one():
    drives = [LINE.drive_index(name) for name in ("unwind", "swrap_follower")]
    assert len(set(drives)) == 2
    names = [one.name for one in LINE.declaration.rollers]
    assert [LINE.arrays.drives["body"][k] for k in drives] == [
        names.index("unwind"),
        names.index("swrap_follower"),
    ]
