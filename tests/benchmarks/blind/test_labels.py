"""What the label of a blind pair says of what can be seen in it."""

import numpy as np
import pytest

from benchmarks.blind.cases import runs, visible
from tests.each_case import each_case


# best rms over noise in a record and in its best 2 s; the labels of shared/data/cases say so
@each_case(
    ("rms", "window", "seen"),
    [(1.092, 1.811, False), (1.438, 4.083, False), (1.41, 4.774, True), (2.249, 3.993, True)],
)
def test_an_effect_counts_as_visible_where_the_pairs_of_the_other_code_say_so(rms, window, seen):
    strong = ["unwind_speed_rad_s", 9.0, "unwind_speed_rad_s", 20.0]
    weak = ["line_speed_m_s", rms, "line_speed_m_s", window]
    other = {"best": [strong, strong]}
    assert visible({"a": {"best": [strong, weak]}, "b": other}) is seen


@pytest.mark.parametrize(
    ("lowest_N", "highest_N", "ran"),
    [(60.0, 120.0, True), (0.0, 120.0, False), (60.0, 480.0, False)],
)
def test_a_line_whose_web_hangs_slack_or_is_torn_at_is_no_record(lowest_N, highest_N, ran):
    tension_N = np.array([90.0, lowest_N, highest_N, 90.0])
    assert runs({"unwind_tension_N": tension_N, "tension_ref_N": np.full(4, 90.0)}) is ran
