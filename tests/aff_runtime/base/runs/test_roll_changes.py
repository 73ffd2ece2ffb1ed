"""Where another roll of web is on, rows without a number among them."""

import numpy as np

from aff_runtime.base.runs.roll_changes import roll_changes
from tests.each_case import each_case

NAN = np.nan


@each_case(
    ("roll_id", "changes"),
    [
        ([1, 1, 2, 2, 3], [2, 4]),
        ([NAN, 1, NAN, 1, 1], []),
        ([1, NAN, 2, NAN], [2]),
        ([NAN, NAN], []),
        ([], []),
    ],
)
def test_a_change_is_seen_where_a_row_names_another_roll_than_the_last_that_named_one(
    roll_id, changes
):
    assert np.flatnonzero(roll_changes(np.array(roll_id, dtype=float))).tolist() == changes
