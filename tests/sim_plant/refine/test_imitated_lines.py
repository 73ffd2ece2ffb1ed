"""Two effects at one spectral line: on the record held out four numbers that imitate show."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_plant.refine.confirm import RecordWithTwin, without_imitated_lines
from sim_plant.refine.imitated_lines import imitated_line
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.model.twin import Case
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.search.selection import AcceptedEffect
from tests.sim_plant.refine.search.rollers import (
    CHANNELS,
    LINE,
    SAMPLES,
    SPEED_M_S,
    nothing_found,
    of_kind,
    put,
    seen,
)
from tests.sim_plant.refine.small import fit_of, formula_twin, quiet, white

HIDDEN = put(of_kind("eccentric_roller", "R4"), 30.0, 10.0)
TRUE = seen(Case(effects=(HIDDEN,)))
_, NOTHING = nothing_found((HIDDEN,))
TWO = (of_kind("unbalanced_roller", "R1"), of_kind("unbalanced_roller", "R6"))


def of(*hypotheses):
    """Return a selection in which these were accepted, at their start."""
    accepted = tuple(
        AcceptedEffect(hypothesis=h, score=1e4, runner_up=None, margin=1e4, rejected=())
        for h in hypotheses
    )
    return replace(
        NOTHING, fit=fit_of(*hypotheses), accepted=accepted, ranges=({},) * len(accepted)
    )


def held_out(wrong):
    """Return a record with the hidden roller, of whose response this share is not answered."""
    measured = TRUE + white(TRUE.shape)
    left = np.sqrt(np.mean((measured - (1.0 - wrong) * TRUE) ** 2, axis=1))
    return Evaluation(
        channels=CHANNELS,
        rms_declared=np.sqrt(np.mean(measured**2, axis=1)),
        rms_amended=left,
        floor=np.ones(3),
        measured=measured,
        declared=np.zeros_like(TRUE),
        corrected=np.zeros_like(TRUE),
        amended=(1.0 - wrong) * TRUE,
        effects=(),
        angles_rad={},
        unwound_m={},
        moments={},
        first=0,
        travel_m=np.cumsum(SPEED_M_S) * 0.01,
    )


TWIN = formula_twin(seen, CHANNELS, SAMPLES, line=LINE, speed_m_s=SPEED_M_S)


@pytest.mark.parametrize(("wrong", "imitate"), [(0.2, True), (0.05, False)])
def test_two_imitate_where_they_leave_more_than_one_percent_of_their_line(wrong, imitate):
    """A response that is wrong by e leaves e^2 of its line: 4 % and 0.25 %; 1 % is the most."""
    assert imitated_line(TWIN, of(*TWO), held_out(wrong)) == ((0, 1) if imitate else None)


def test_one_of_another_radius_and_one_alone_are_no_pair():
    other = of_kind("unbalanced_roller", "R8")
    assert imitated_line(TWIN, of(TWO[0], other), held_out(0.2)) is None
    assert imitated_line(TWIN, of(TWO[0]), held_out(0.2)) is None


def test_what_is_below_noise_is_left_by_two_true_ones_too():
    faint = replace(
        held_out(0.2), measured=0.002 * TRUE + white(TRUE.shape), amended=np.zeros_like(TRUE)
    )
    assert imitated_line(TWIN, of(*TWO), faint) is None


def test_two_that_imitate_are_withdrawn_and_their_line_is_unknown():
    columns = dict(zip(CHANNELS, held_out(0.2).measured, strict=True))
    record = Recording(path=Path("B.csv"), sha256="", sample_time_s=0.01, columns=columns)
    judged = RecordWithTwin(record=record, twin=TWIN)
    claimed = without_imitated_lines(judged, of(*TWO), held_out(0.2), 1, quiet)
    assert claimed.selection.accepted == ()
    (unknown,) = claimed.selection.unknown
    assert unknown.unknown_class == "travel"
    assert unknown.coordinate["equivalent_radius_m"] == pytest.approx(0.04, rel=0.01)
    (said,) = claimed.said
    assert "unbalanced_roller at R1 and unbalanced_roller at R6" in said
    assert "B.csv" in said
