"""Which of several effects may count as an imitation on the record held out."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.confirm import (
    Judgement,
    RecordWithTwin,
    judge,
    without_imitations,
    without_sizeless,
    without_weakest_imitation,
)
from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.findings import verdict_of
from sim_plant.refine.report.wording import coordinate_text
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from sim_plant.refine.search.taken_back import without_accepted
from tests.each_case import each_case
from tests.sim_plant.refine.small import LINE, fit_of, formula_twin, one_peak, quiet

SAMPLES = 2000
IN_UNWIND = ("unwind_zone", "unwind_tension_N")
DRAGS = [
    hypothesis(BY_NAME["bearing_drag"], place, fitted=("constant_N_m", "from_s"), line=LINE)
    for place in ("R5", "R7")
]


def held_out(noise=2.0**0.5, sine_N=0.0):
    """A record in which no drag begins, with noise of this size, and a sine of 0.9 Hz."""
    twin = formula_twin(lambda _case: np.zeros((1, SAMPLES)), ["unwind_tension_N"], SAMPLES)
    force = noise * np.random.default_rng(3).standard_normal(SAMPLES)
    force += sine_N * np.sin(2.0 * np.pi * 0.9 * 0.01 * np.arange(SAMPLES))
    columns = {"unwind_tension_N": force}
    record = Recording(path=Path("B"), sha256="", sample_time_s=0.01, columns=columns)
    return RecordWithTwin(record=record, twin=twin)


def of_both(moments, after=2.0**0.5):
    one = np.ones(1)
    return Evaluation(
        channels=("unwind_tension_N",),
        rms_declared=after * one,
        rms_amended=after * one,
        floor=one,
        measured=np.zeros((1, SAMPLES)),
        declared=np.zeros((1, SAMPLES)),
        corrected=np.zeros((1, SAMPLES)),
        amended=np.zeros((1, SAMPLES)),
        effects=(),
        angles_rad={},
        unwound_m={},
        moments=moments,
        first=0,
        travel_m=np.zeros(SAMPLES),
    )


@each_case(
    ("there", "left_out"), [((), None), (("R5",), "R5"), (("R7",), "R7"), (("R5", "R7"), "R7")]
)
def test_an_event_that_the_record_does_not_have_is_no_imitation_of_what_is_left(there, left_out):
    """R7 explains less of the fitted record than R5; none takes power from this one."""
    evaluation = of_both({f"bearing_drag at {place}": 40.0 for place in there})
    found = without_weakest_imitation(Judgement(held_out(), both_drags(), evaluation, 1, quiet))
    if left_out is None:
        assert found is None
    else:
        assert found is not None
        assert f"bearing_drag at {left_out}" in found.said


def both_drags():
    """R5 and R7 as they were found on the fitted record."""
    accepted = tuple(
        AcceptedEffect(hypothesis=h, score=score, runner_up=None, margin=score, rejected=())
        for h, score in zip(DRAGS, (900.0, 600.0), strict=True)
    )
    return Selection(
        nominal=fit_of(cost=1e4),
        fit=fit_of(*DRAGS),
        record_axes=(),
        spectra_declared=one_peak(),
        spectra_left=one_peak(),
        accepted=accepted,
        ranges=({}, {}),
    )


@pytest.mark.parametrize(
    ("noise", "sine_N", "kind"), [(1.0, 4.0, "time"), (2.0, 0.0, "broadband"), (1.0, 0.0, None)]
)
def test_what_an_imitation_leaves_is_unknown_where_the_record_shows_it(noise, sine_N, kind):
    """16 / 2 of the power of noise in a sine, 3 in noise; without either nothing is left."""
    judged = held_out(noise, sine_N)
    begun = {"bearing_drag at R5": 40.0, "bearing_drag at R7": 40.0}
    evaluation = of_both(begun, max(2.0, noise**2 + 0.5 * sine_N**2) ** 0.5)
    found = without_imitations(judged, both_drags(), evaluation, 1, quiet)
    (claimed,) = found.selection.accepted
    assert claimed.hypothesis.location == "R5"
    verdict = verdict_of(found.selection, found.evaluation, "B")
    assert verdict.answer == ("traced" if kind is None else "unknown")
    assert [u.unknown_class for u in found.selection.unknown] == ([] if kind is None else [kind])
    assert len(found.said) == 1 + (kind is not None)
    if kind == "time":
        (stays,) = found.selection.unknown
        assert stays.coordinate["frequency_Hz"] == pytest.approx(0.9, abs=0.04)  # half a bin
        assert (stays.coordinate["zone"], stays.coordinate["channel"]) == IN_UNWIND


def test_an_effect_that_may_have_no_size_is_not_claimed_and_what_stays_is_unknown():
    judged, both = held_out(1.0, 4.0), both_drags()
    values = ((0.3, 10.0), (0.2, 20.0))
    sd = np.array([0.01, 0.01, 0.15, 0.01])
    fit = replace(both.fit, values=values, covariance=np.diag(sd**2))
    sizeless = replace(both, fit=fit)
    found = without_sizeless(judged, sizeless, of_both({}, 3.0), 1, quiet)
    (said,) = found.said
    assert said.startswith("not claimed: bearing_drag at R7: ")
    assert "its size may be none" in said
    found = without_imitations(judged, found.selection, found.evaluation, 1, quiet, found.said)
    (claimed,) = found.selection.accepted
    assert claimed.hypothesis.location == "R5"
    assert [u.unknown_class for u in found.selection.unknown] == ["time"]
    assert found.said[0] == said


def test_beside_slip_no_line_is_named_for_its_changes_have_slow_ones_of_their_own():
    slip = hypothesis(BY_NAME["slip"], "swrap", line=LINE)
    both = both_drags()
    first = replace(both.accepted[0], hypothesis=slip, score=2e5)
    selection = replace(both, accepted=(first, both.accepted[1]), fit=fit_of(slip, DRAGS[1]))
    evaluation = of_both({"bearing_drag at R7": 40.0}, 3.0)
    found = without_imitations(held_out(1.0, 4.0), selection, evaluation, 1, quiet)
    (claimed,), (stays,) = found.selection.accepted, found.selection.unknown
    assert claimed.hypothesis == slip
    assert (stays.unknown_class, dict(stays.coordinate)) == ("broadband", {})


def test_without_an_imitation_little_of_what_was_there_is_no_unknown():
    """1 of the power of noise is surely more than that, and 1 % of what the effects explain."""
    evaluation = replace(of_both({}), rms_declared=np.full(1, 10.0))
    selection = both_drags()
    found = without_imitations(held_out(), selection, evaluation, 1, quiet)
    assert (found.selection, found.evaluation, found.said) == (selection, evaluation, ())


def beside_something_else(rest, size_N=2.0):
    """A drag whose response is a sine of 1.7 Hz, shown by a record that has ``rest`` too."""
    record = held_out(1.0)
    response = size_N * np.sin(2.0 * np.pi * 1.7 * 0.01 * np.arange(SAMPLES))
    measured = (record.record.columns["unwind_tension_N"] + response + rest)[None]
    evaluation = replace(
        of_both({}),
        rms_declared=np.sqrt(np.mean(measured**2, axis=1)),
        rms_amended=np.sqrt(np.mean((measured - response) ** 2, axis=1)),
        measured=measured,
        amended=response[None],
    )
    lone = without_accepted(both_drags(), 1)
    return without_imitations(record, lone, evaluation, 1, quiet)


def test_what_begins_in_the_record_held_out_is_unknown_beside_the_effect_that_it_shows():
    found = beside_something_else(4.0 * (np.arange(SAMPLES) >= 1200))
    (claimed,), (begins,) = found.selection.accepted, found.selection.unknown
    assert claimed.hypothesis.location == "R5"
    assert begins.unknown_class == "event"
    assert begins.coordinate["from_s"] == pytest.approx(12.0, abs=0.05)
    assert begins.coordinate["held_out"] == "B"
    verdict = verdict_of(found.selection, found.evaluation, "B", [("A", held_out().twin)])
    assert verdict.answer == "unknown"
    (told,) = verdict.unknown
    assert told.begins is None  # no moment of the record fitted
    assert "s of B in unwind_zone" in coordinate_text(told.unknown_class, told.coordinate)


def test_a_line_in_the_record_held_out_is_unknown_beside_the_effect_that_it_shows():
    found = beside_something_else(4.0 * np.sin(2.0 * np.pi * 0.9 * 0.01 * np.arange(SAMPLES)))
    (claimed,), (stays,) = found.selection.accepted, found.selection.unknown
    assert claimed.hypothesis.location == "R5"
    assert stays.unknown_class == "time"
    assert stays.coordinate["frequency_Hz"] == pytest.approx(0.9, abs=0.04)  # half a bin


def test_a_drift_of_the_record_held_out_is_no_line():
    """One cycle in the record is less than the eight of a line."""
    found = beside_something_else(4.0 * np.sin(2.0 * np.pi * 0.05 * 0.01 * np.arange(SAMPLES)))
    (claimed,), (stays,) = found.selection.accepted, found.selection.unknown
    assert claimed.hypothesis.location == "R5"
    assert (stays.unknown_class, dict(stays.coordinate)) == ("broadband", {})


STEADY = [
    hypothesis(BY_NAME["bearing_drag"], place, fitted=("constant_N_m",), line=LINE)
    for place in ("R5", "R7")
]
RESPONSES_N = {
    place: size * np.sin(2.0 * np.pi * at_Hz * 0.01 * np.arange(SAMPLES))
    for place, size, at_Hz in (("R5", 6.0, 1.7), ("R7", 1.5, 5.3))
}


@pytest.mark.parametrize(("step_N", "answer"), [(4.0, "unknown"), (1.0, "traced")])
def test_a_weak_effect_that_its_response_keeps_stays_beside_an_unknown(step_N, answer):
    """What recurs with the cause of R7 is shown with slope 1 too, whatever it is.

    R7 takes 1.1 of the power of noise of the 8.5 that a step of 4 N from 12 s on leaves, less than
    half of the 28 that the record shows; a step of 1 N leaves 0.5.
    """

    def formula(case):
        return sum((RESPONSES_N[e.location] for e in case.effects), np.zeros(SAMPLES))[None]

    twin = formula_twin(formula, ["unwind_tension_N"], SAMPLES)
    noise = np.random.default_rng(3).standard_normal(SAMPLES)
    force = noise + step_N * (np.arange(SAMPLES) >= 1200) + sum(RESPONSES_N.values())
    record = replace(held_out().record, columns={"unwind_tension_N": force})
    judged = RecordWithTwin(record=record, twin=twin)
    accepted = tuple(
        replace(a, hypothesis=h) for a, h in zip(both_drags().accepted, STEADY, strict=True)
    )
    both = replace(both_drags(), accepted=accepted, fit=fit_of(*STEADY))
    evaluation = judge(judged, both, 1, quiet, held_out=True)
    found = without_imitations(judged, both, evaluation, 1, quiet)
    verdict = verdict_of(found.selection, found.evaluation, "B")
    assert [effect.place.location for effect in verdict.effects] == ["R5", "R7"]
    assert verdict.answer == answer
    assert [u.unknown_class for u in verdict.unknown] == ["event"] * (answer == "unknown")


def test_little_beside_the_effect_is_no_unknown():
    found = beside_something_else(0.5 * (np.arange(SAMPLES) >= 1200))
    assert (found.selection.unknown, found.said) == ((), ())


@pytest.mark.parametrize(("step_N", "classes"), [(4.0, []), (6.0, ["event"])])
def test_an_effect_that_leaves_more_than_right_ones_do_is_not_told_alone(step_N, classes):
    """Of a sine of 20 N, power 200, a step over 0.4 of the record leaves 3 % and 7 %."""
    found = beside_something_else(step_N * (np.arange(SAMPLES) >= 1200), 20.0)
    (claimed,) = found.selection.accepted
    assert claimed.hypothesis.location == "R5"
    assert [u.unknown_class for u in found.selection.unknown] == classes
    verdict = verdict_of(found.selection, found.evaluation, "B")
    assert verdict.answer == ("unknown" if classes else "traced")
