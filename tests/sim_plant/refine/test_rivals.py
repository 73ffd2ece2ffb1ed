"""What the next best explanation leaves in the place of an effect, against a formula."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.confirm import RecordWithTwin
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit, nominal_fit
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.twin import Case
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.rivals import left_by_rivals, with_rivals_refitted
from sim_plant.refine.search.candidate import fitted_candidate
from sim_plant.refine.search.selection import Selection, accept
from sim_plant.refine.search.unexplained import Unknown
from tests.sim_plant.refine.small import (
    STEP_S,
    formula_twin,
    line_with,
    objective_of,
    quiet,
    white,
)

SAMPLES = 2000
LINE = line_with()
TURN_RAD = 0.7 * STEP_S * np.arange(SAMPLES)
AHEAD_RAD = {"R1": 0.1, "R2": 0.2}
"""By how much an eccentric roller is seen earlier at the second cell than at the first."""
TRUE = (2e-4, 1e-4)
AMPLITUDE_N = 1e5 * np.hypot(*TRUE)
CHANNELS = ("pullroll_tension_N", "unwind_tension_N")
ONE, OTHER = (hypothesis(BY_NAME["eccentric_roller"], at, line=LINE) for at in AHEAD_RAD)


def turning(case):
    both = np.zeros((2, SAMPLES))
    for added in case.effects:
        given = dict(added.parameters)
        for row, ahead_rad in enumerate((0.0, AHEAD_RAD[added.location])):
            both[row] += 1e5 * given["cos_m"] * np.cos(TURN_RAD + ahead_rad)
            both[row] += 1e5 * given["sin_m"] * np.sin(TURN_RAD + ahead_rad)
    return both


@pytest.fixture(scope="module")
def found():
    """Return the objective of a record of R2 off its centre, and that it was found, R1 behind."""
    twin = formula_twin(turning, CHANNELS, SAMPLES, line=LINE)
    objective = objective_of(twin, record_of(8))
    base = nominal_fit(objective, {})
    fits = (gauss_newton_fit(objective, (h,), (h.start,), {}) for h in (ONE, OTHER))
    scored = [fitted_candidate(objective, base, fit) for fit in fits]
    scored.sort(key=lambda c: -c.score)
    empty = Selection(nominal=base, fit=base, record_axes=(), spectra_declared=(), spectra_left=())
    extension = accept(empty, scored, (), quiet)
    selection = replace(empty, fit=extension.fit, accepted=(extension.accepted,))
    return objective, selection


def record_of(seed):
    return turning(Case(effects=(OTHER.added(TRUE),))) + white((2, SAMPLES), seed)


def judged(seed):
    twin = formula_twin(turning, CHANNELS, SAMPLES, line=LINE)
    columns = dict(zip(CHANNELS, record_of(seed), strict=True))
    record = Recording(path=Path("b.csv"), sha256="", sample_time_s=STEP_S, columns=columns)
    return RecordWithTwin(record=record, twin=twin)


def test_the_rival_leaves_on_another_record_what_its_phase_cannot_follow(found):
    """Half of the phase between the two cells is left in each: sin(0.1 / 2) of the amplitude.

    Noise decides between the two, so their mean square is what is known beforehand.
    """
    objective, selection = found
    assert str(selection.accepted[0].runner_up) == "eccentric_roller at R1"
    both = with_rivals_refitted(objective, selection, quiet)
    (left,) = left_by_rivals(judged(9), both, 1, quiet, held_out=False)
    rest_N = AMPLITUDE_N * np.sin(0.05)
    of_both = np.sqrt(np.mean(np.square([left[name] for name in CHANNELS])))
    assert of_both == pytest.approx(np.sqrt(1.0 + 0.5 * rest_N**2), rel=0.02)


def test_what_cannot_be_compared_is_not_judged(found):
    objective, selection = found
    both = with_rivals_refitted(objective, selection, quiet)
    unknown = Unknown(unknown_class="broadband", chi2_reduction=1e4, coordinate={})
    assert (
        left_by_rivals(judged(9), replace(both, unknown=(unknown,)), 1, quiet, held_out=False)[0]
        == {}
    )
    (never,) = selection.accepted
    unfitted = replace(selection, accepted=(replace(never, rival=None),))
    other = replace(selection, accepted=(replace(never, runner_up=OTHER.key),))
    beside = replace(selection, unknown=(unknown,))
    for one in (unfitted, other, beside):
        assert with_rivals_refitted(objective, one, quiet).accepted[0].rival is None
