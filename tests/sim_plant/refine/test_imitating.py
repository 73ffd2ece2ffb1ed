"""Which of several effects may count as an imitation on the record held out."""

from pathlib import Path

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.pipeline import Recorded, imitating
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from tests.sim_plant.refine.small import LINE, fit_of, formula_twin, one_peak, quiet

SAMPLES = 2000
DRAGS = [
    hypothesis(BY_NAME["bearing_drag"], place, traced=("constant_N_m", "from_s"), line=LINE)
    for place in ("R5", "R7")
]


def held_out():
    """A record in which no drag begins, with twice the power of noise left."""
    twin = formula_twin(lambda _case: np.zeros((1, SAMPLES)), ["unwind_tension_N"], SAMPLES)
    force = np.sqrt(2.0) * np.random.default_rng(3).standard_normal(SAMPLES)
    columns = {"unwind_tension_N": force}
    record = Recording(path=Path("B"), sha256="", sample_time_s=0.01, columns=columns)
    return Recorded(record=record, twin=twin)


def of_both(moments):
    one = np.ones(1)
    return Evaluation(
        channels=("unwind_tension_N",),
        before=np.sqrt(2.0) * one,
        after=np.sqrt(2.0) * one,
        floor=one,
        measured=np.zeros((1, SAMPLES)),
        declared=np.zeros((1, SAMPLES)),
        amended=np.zeros((1, SAMPLES)),
        effects=(),
        angles_rad={},
        unwound_m={},
        moments=moments,
        first=0,
        travel_m=np.zeros(SAMPLES),
    )


@pytest.mark.parametrize(
    ("there", "left_out"), [((), None), (("R5",), "R5"), (("R7",), "R7"), (("R5", "R7"), "R7")]
)
def test_an_event_that_the_record_does_not_have_is_no_imitation_of_what_is_left(there, left_out):
    """R7 explains less of the fitted record than R5; none takes power from this one."""
    accepted = tuple(
        AcceptedEffect(hypothesis=h, score=score, runner_up=None, margin=score, rejected=())
        for h, score in zip(DRAGS, (900.0, 600.0), strict=True)
    )
    selection = Selection(
        nominal=fit_of(cost=1e4),
        fit=fit_of(*DRAGS),
        travels=(),
        before=one_peak(),
        after=one_peak(),
        accepted=accepted,
        ranges=({}, {}),
    )
    evaluation = of_both({f"bearing_drag at {place}": 40.0 for place in there})
    found = imitating(held_out(), selection, evaluation, 1, quiet)
    if left_out is None:
        assert found is None
    else:
        assert found is not None
        assert f"bearing_drag at {left_out}" in found.said
