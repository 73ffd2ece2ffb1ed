from pathlib import Path

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.announce import (
    announce,
    holdout_caveats,
    radii_of_profiles,
    shared_angle,
)
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from tests.each_case import each_case
from tests.sim_plant.refine.small import LINE, fit_of, line_with, one_peak


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


@each_case(
    ("name", "change", "told"),
    [
        ("out_of_round_roll", 0.0021, True),  # 4.2 standard deviations of a tolerance of 0.1 %
        ("out_of_round_roll", -0.0021, True),
        ("out_of_round_roll", 0.0019, False),
        ("torque_ripple", 0.0021, False),  # beside that a radius error is an effect of its own
    ],
)
def test_a_radius_error_beside_a_profile_is_named_as_what_cannot_be_told(name, change, told):
    number = "rollers.unwind.effective_radius"
    h = hypothesis(BY_NAME[name], "unwind", line=LINE)
    found = AcceptedEffect(hypothesis=h, score=1e4, runner_up=None, margin=1e4, rejected=())
    selection = Selection(
        nominal=fit_of(),
        fit=fit_of(h),
        record_axes=(),
        spectra_declared=one_peak(),
        spectra_left=one_peak(),
        accepted=(found,),
        adjustments={number: change},
    )
    said = radii_of_profiles(selection, line_with({"*": 0.0, number: 0.001}))
    assert len(said) == told
    if told:
        assert said[0].startswith("a wrong radius in drive unwind")
        assert f"{100.0 * change:+.2g} % off" in said[0]
    assert radii_of_profiles(selection, line_with({"*": 0.0})) == []  # known exactly


def test_caveats_are_said_first_then_what_is_odd_about_each_record():
    said = []
    announce(["one speed only"], [record("a.csv", "2 spikes"), record("b.csv")], said.append)
    assert said == ["cannot be claimed: one speed only", "a.csv: 2 spikes"]
