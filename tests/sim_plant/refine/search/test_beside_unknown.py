"""Beside a declared number that is surely off a search goes on; before an event effects stay."""

from dataclasses import replace

import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit, nominal_fit
from sim_plant.refine.fit.objective import with_free_numbers
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search import forward_selection as search
from sim_plant.refine.search.outside_prior import joint_conflict
from sim_plant.refine.search.remainder import shown_before
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from sim_plant.refine.search.unexplained import Unknown
from tests.sim_plant.refine.small import (
    STEP_S,
    axes_at,
    fit_of,
    formula_twin,
    line_with,
    objective_of,
    quiet,
    white,
)

SAMPLES = 2400
CHANNELS = ("unwind_tension_N", "rewind_tension_N", "unwind_speed_rad_s")
NUMBER = "web.EA_N"
BY_NUMBER = white((3, SAMPLES), seed=11)
BY_DRAG = white((3, SAMPLES), seed=12)
DRAG = hypothesis(BY_NAME["bearing_drag"], "R4")
MODULUS = hypothesis(BY_NAME["web_modulus"], "web", line=line_with())
OFF = Unknown(
    unknown_class="state",
    coordinate={"declared": NUMBER, "standard_deviations": 30.0},
    chi2_reduction=900.0,
)


def line(case):
    """Return channels that a modulus and a drag move by noise of their own."""
    drag = sum(dict(e.parameters)["constant_N_m"] for e in case.effects)
    return dict(case.shifts).get(NUMBER, 0.0) * 20.0 * BY_NUMBER + drag * 20.0 * BY_DRAG


def objective(shift, drag):
    measured = shift * 20.0 * BY_NUMBER + drag * 20.0 * BY_DRAG + white((3, SAMPLES), seed=4)
    return objective_of(formula_twin(line, CHANNELS, SAMPLES), measured)


HELD = objective(0.2, 0.02)
JUDGED = SAMPLES - HELD.whitening.noise[0].first


def test_of_a_free_number_the_tolerance_does_not_count():
    """The modulus is declared to 2 %, two standard deviations: 20 % off are twenty of them."""
    free = with_free_numbers(HELD, {NUMBER})
    assert joint_conflict(HELD, nominal_fit(HELD)).standard_deviations > 18.0
    assert joint_conflict(free, nominal_fit(free)) is None
    kept = nominal_fit(HELD).cost - nominal_fit(free).cost
    assert kept == pytest.approx(19.0**2, rel=0.1)  # z squared, shrunk a little by the tolerance


def found(*effects, unknown=()):
    fit = fit_of(*effects, cost=HELD.expected_cost, residual=nominal_fit(HELD).residual)
    accepted = tuple(
        AcceptedEffect(hypothesis=h, score=900.0, runner_up=None, margin=9.0, rejected=())
        for h in effects
    )
    return Selection(
        nominal=fit,
        fit=fit,
        record_axes=(axes_at([1.0] * JUDGED),),
        spectra_declared=(),
        spectra_left=(),
        accepted=accepted,
        unknown=tuple(unknown),
    )


@pytest.mark.parametrize(
    ("still_off", "told"), [(True, [NUMBER]), (False, [])], ids=["still off", "imitated"]
)
def test_the_search_goes_on_with_the_number_free_and_names_it_only_if_it_is_still_off(
    still_off, told, monkeypatch
):
    asked = []

    def select(target, library, *rest, **more):
        asked.append(({n.name for n in target.nuisances if n.is_free}, library))
        return found(unknown=[OFF]) if len(asked) == 1 else found(DRAG)

    steps = {
        "select": select,
        "whole_of": lambda *rest: None,
        "joint_refit": lambda near, fit: (near, fit),
        "classified": lambda near, selection: selection,
        "joint_conflict": lambda *rest: OFF if still_off else None,
        "total_shifts": lambda *rest: {},
    }
    for name, step in steps.items():
        monkeypatch.setattr(search, name, step)
    end = search.forward_selection(HELD, [DRAG, MODULUS], quiet)
    assert asked == [(set(), [DRAG, MODULUS]), ({NUMBER}, [DRAG])]
    assert [a.hypothesis for a in end.accepted] == [DRAG]
    assert [u.declared for u in end.unknown] == told


@pytest.mark.parametrize(("judged_s", "stays"), [(0.2, []), (6.0, [0])])
def test_an_effect_that_is_shown_before_an_event_stays(judged_s, stays):
    """0.06 N m take some 1.4 times the noise's power: 400 need a second of three channels."""
    seen = objective(0.0, 0.06)
    fit = gauss_newton_fit(seen, [DRAG], [(0.06,)], {}, rounds=0, quick=False)
    from_s = STEP_S * seen.whitening.noise[0].first + judged_s
    event = Unknown(unknown_class="event", coordinate={"from_s": from_s}, chi2_reduction=9.0)
    selection = Selection(
        nominal=fit,
        fit=fit,
        record_axes=(),
        spectra_declared=(),
        spectra_left=(),
        unknown=(event,),
    )
    assert shown_before(seen, selection) == stays


def test_effects_taken_back_at_the_end_leave_no_interval_behind(monkeypatch):
    """What is told as one thing in the end had effects, with intervals, beside its lines."""
    line = Unknown(unknown_class="time", coordinate={"frequency_Hz": 1.0}, chi2_reduction=9.0)
    gap = Unknown(unknown_class="state", coordinate={"gap_N": 1.0}, chi2_reduction=9.0)
    loud = replace(found(DRAG, unknown=[line]), ranges=({"constant_N_m": (0.0, 1.0)},))
    loud = replace(loud, fit=replace(loud.fit, cost=HELD.expected_cost + 1e6))
    monkeypatch.setattr(search, "select", lambda *rest, **more: loud)
    monkeypatch.setattr(search, "whole_of", lambda *rest: gap)
    end = search.forward_selection(HELD, [DRAG], quiet)
    assert (end.accepted, end.ranges, end.unknown) == ((), (), (gap,))
