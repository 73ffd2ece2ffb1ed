from pathlib import Path

import numpy as np
import pytest

from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.announce import announce, holdout_caveats, shared_angle


def record(name, *findings):
    columns = {"x_N": np.ones(9)}
    return Recording(
        path=Path(name), sha256=name, sample_time_s=0.01, columns=columns, findings=findings
    )


@pytest.mark.parametrize(
    ("held", "said"),
    [
        ([], "no held-out record: the error after is that of the record fitted"),
        (["h0.csv", "h1.csv"], "more than one held-out record: the errors are those of h0.csv"),
    ],
)
def test_the_number_of_held_out_records_limits_what_can_be_claimed(held, said):
    assert holdout_caveats([record(name) for name in held]) == [said]


def test_one_held_out_record_limits_nothing():
    assert holdout_caveats([record("h.csv")]) == []


def test_several_fitted_records_have_one_start_angle_and_the_page_says_so():
    assert shared_angle([record("a.csv")]) == []
    (said,) = shared_angle([record("a.csv"), record("b.csv")])
    assert said.startswith("a.csv and b.csv are fitted with one start angle per effect")
    assert said.endswith("give one of them, and hold another out")


def test_caveats_are_said_first_then_what_is_odd_about_each_record():
    said = []
    announce(["one speed only"], [record("a.csv", "2 spikes"), record("b.csv")], said.append)
    assert said == ["cannot be claimed: one speed only", "a.csv: 2 spikes"]
