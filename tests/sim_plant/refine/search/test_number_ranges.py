"""The intervals that are told: of sizes, of ticks, of what no record shows."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME, CATALOGUE
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit, jacobian, nominal_fit
from sim_plant.refine.fit.robust_covariance import robust_covariance
from sim_plant.refine.fit.spread import SPREAD
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.twin import Case
from sim_plant.refine.search.number_ranges import hidden, with_number_ranges
from sim_plant.refine.search.profile_age import with_numbers
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from sim_plant.refine.search.taken_back import withdrawn, without_accepted
from tests.sim_plant.refine.small import LINE, fit_of, formula_twin, objective_of, one_peak, white

CHANNELS, SAMPLES = ("unwind_tension_N", "rewind_tension_N"), 6000
STEPS = np.sign(np.sin(2.0 * np.pi * np.arange(SAMPLES) / 1700.0))
SHARES = np.array([[1.0], [-0.5]])
SLACK = 0.004
"""Play of a shaft up to which nothing turns in it, rad."""


def response(case):
    """Return two tensions without delay: a square wave, later by a delay, less with play."""
    found = np.zeros((2, SAMPLES))
    for effect in case.effects:
        size = dict(effect.parameters)
        if effect.effect == "loop_delay":
            ticks = round(size["delay_s"] / 0.001)
            found += 3.0 * SHARES * np.roll(STEPS, ticks)
        elif effect.effect == "shaft_compliance_backlash":
            felt = max(0.0, size.get("backlash_rad", 0.0) - SLACK)
            found += 1e3 * SHARES * (size["compliance_rad_N_m"] - felt**2) * STEPS
        else:
            found += 50.0 * size["constant_N_m"] * SHARES * STEPS
    return found


def selected(h, true, start=None, score=1000.0):
    """Return the objective of a record with an effect of these numbers, and what was found."""
    measured = response(Case(effects=(h.added(true),))) + white((2, SAMPLES), 5)
    objective = objective_of(formula_twin(response, CHANNELS, SAMPLES), measured)
    nominal = nominal_fit(objective)
    fit = gauss_newton_fit(objective, [h], [start or true], {}, rounds=0 if start else 6)
    accepted = AcceptedEffect(hypothesis=h, score=score, runner_up=None, margin=0.0, rejected=())
    return objective, Selection(
        nominal=nominal,
        fit=fit,
        record_axes=(),
        spectra_declared=one_peak(500.0),
        spectra_left=one_peak(),
        accepted=(accepted,),
    )


def test_a_plain_size_lies_within_noise_and_what_a_model_has_wrong_of_it():
    drag = hypothesis(BY_NAME["bearing_drag"], "R2", (), ("constant_N_m",), LINE)
    objective, selection = selected(drag, (0.2,))
    found = with_number_ranges(objective, selection)
    low, high = found.ranges[0]["constant_N_m"]
    noise = 1.0 / (50.0 * math.sqrt(1.25 * (SAMPLES - 1500)))
    sd = math.hypot(noise, 0.2 * CRITERIA.report.model_share)
    assert 0.5 * (high - low) == pytest.approx(SPREAD * sd, rel=0.3)
    assert low < 0.2 < high


def test_what_a_size_explains_widens_it_by_no_more_than_its_own_error():
    """What e of an answer may be, e of the size is, however many standard deviations it is."""
    drag = hypothesis(BY_NAME["bearing_drag"], "R2", (), ("constant_N_m",), LINE)
    widths = []
    for score in (1e3, 1e7):
        found = with_number_ranges(*selected(drag, (0.2,), score=score))
        low, high = found.ranges[0]["constant_N_m"]
        widths.append(high - low)
    assert widths[1] == pytest.approx(widths[0], rel=1e-6)


def test_a_variance_of_twelve_runs_counts_by_students_t():
    drag = hypothesis(BY_NAME["bearing_drag"], "R2", (), ("constant_N_m",), LINE)
    objective, selection = selected(drag, (0.002,))
    noise = white((12, 2, SAMPLES), 8)
    noise[:, 1] = -noise[:, 0]  # shares of the answer are 1 and -0.5: it moves it by more
    whitening = replace(objective.whitening, realisations=(noise,))
    objective = replace(objective, whitening=whitening)
    low, high = with_number_ranges(objective, selection).ranges[0]["constant_N_m"]
    column = jacobian(objective, (drag,), selection.fit.values, selection.fit.shifts)
    robust = robust_covariance(objective, column, selection.fit.residual)
    assert robust.degrees_of_freedom[0] == 11.0
    sd = math.sqrt(robust.variance[0] + robust.tolerances[0, 0])
    own = 0.002 * CRITERIA.report.model_share
    # 0.975 quantile of Student's t of 11 degrees of freedom
    assert 0.5 * (high - low) == pytest.approx(math.hypot(2.201 * sd, SPREAD * own), rel=0.01)


RAMP = np.linspace(-1.0, 1.0, SAMPLES)


def beside_modulus(case):
    """Return two tensions that answer to a drag, and to the modulus half as to a drag."""
    sizes = [dict(e.parameters)["constant_N_m"] for e in case.effects]
    change = dict(case.shifts).get("web.EA_N", 0.0)
    return SHARES * (50.0 * sum(sizes) * STEPS + 100.0 * change * (0.5 * STEPS + RAMP))


@pytest.mark.parametrize(("modulus", "reaches"), [(0.08, True), (0.01, False)])
def test_a_declared_number_far_off_widens_what_it_may_have_taken_along(modulus, reaches):
    """Its tolerance is 0.02: at 0.08 it may imitate what the model has wrong, at 0.01 it may not.

    The interval then holds what the drag is where the modulus stays as declared.
    """
    drag = hypothesis(BY_NAME["bearing_drag"], "R2", (), ("constant_N_m",), LINE)
    true = Case(effects=(drag.added((0.2,)),), shifts=(("web.EA_N", modulus),))
    measured = beside_modulus(true) + white((2, SAMPLES), 5)
    objective = objective_of(formula_twin(beside_modulus, CHANNELS, SAMPLES), measured)
    fit = gauss_newton_fit(objective, [drag], [(0.2,)], {})
    first = objective.whitening.noise[0].first
    extra = 100.0 * modulus * (0.5 * STEPS + RAMP)[first:]
    without = 0.2 + np.dot(extra, STEPS[first:]) / (50.0 * np.dot(STEPS[first:], STEPS[first:]))
    accepted = AcceptedEffect(hypothesis=drag, score=1e3, runner_up=None, margin=0.0, rejected=())
    found = with_number_ranges(
        objective,
        Selection(
            nominal=nominal_fit(objective),
            fit=fit,
            record_axes=(),
            spectra_declared=one_peak(500.0),
            spectra_left=one_peak(),
            accepted=(accepted,),
        ),
    )
    low, high = found.ranges[0]["constant_N_m"]
    assert fit.values[0][0] == pytest.approx(0.2, abs=0.005)
    assert low < 0.2 < high
    assert bool(high > without - 0.001) is reaches


def test_a_delay_is_known_to_a_drive_tick_however_quiet_the_record():
    delay = hypothesis(BY_NAME["loop_delay"], "unwind", (), ("delay_s",), LINE)
    objective, selection = selected(delay, (0.018,))
    low, high = with_number_ranges(objective, selection).ranges[0]["delay_s"]
    tick_s = LINE.control.drive_sample_time_s
    assert high - 0.018 >= SPREAD * tick_s / math.sqrt(3.0) * 0.999
    assert 0.018 - low >= SPREAD * tick_s / math.sqrt(3.0) * 0.999


def test_play_that_no_record_shows_may_be_anything_up_to_where_it_would_show():
    shaft = hypothesis(
        BY_NAME["shaft_compliance_backlash"],
        "unwind",
        (("backlash_rad", 0.0),),
        ("compliance_rad_N_m",),
        LINE,
    )
    assert hidden(shaft) == ["backlash_rad"]
    objective, selection = selected(shaft, (0.003,))
    found = with_number_ranges(objective, selection)
    low, high = found.ranges[0]["backlash_rad"]
    assert low == 0.0
    assert high > SLACK
    # what play would take the spring would have to give: it reaches as far
    assert found.ranges[0]["compliance_rad_N_m"][1] >= 0.003


def test_an_effect_of_one_record_stays_in_it_when_more_of_its_numbers_are_free():
    effect = BY_NAME["splice"]
    seam = hypothesis(effect, "web", (("EA_factor", 1.0),), ("step_m", "at_length_m"), LINE)
    fit = fit_of(replace(seam, record_index=1), values=((5e-4, 20.0),))
    drag = hypothesis(BY_NAME["bearing_drag"], "R2", (), ("constant_N_m",), LINE)
    objective, _ = selected(drag, (0.2,))
    wider = with_numbers(objective, fit, 0, ("EA_factor",), {"EA_factor": 1.0})
    assert wider.hypotheses[0].record_index == 1
    assert dict(zip(wider.hypotheses[0].names, wider.values[0], strict=True)) == {
        "EA_factor": 1.0,
        "step_m": 5e-4,
        "at_length_m": 20.0,
    }


def test_numbers_that_explain_more_are_taken_when_a_walk_comes_by_them():
    delay = hypothesis(BY_NAME["loop_delay"], "unwind", (), ("delay_s",), LINE)
    objective, selection = selected(delay, (0.018,), start=(0.021,))
    found = with_number_ranges(objective, selection)
    assert found.fit.cost < selection.fit.cost - CRITERIA.search.acceptance.margin
    assert abs(found.fit.values[0][0] - 0.018) < abs(0.021 - 0.018)


def test_without_an_effect_there_are_no_ranges_and_with_it_gone_none_of_it():
    drag = hypothesis(BY_NAME["bearing_drag"], "R2", (), ("constant_N_m",), LINE)
    objective, selection = selected(drag, (0.2,))
    found = with_number_ranges(objective, selection)
    assert without_accepted(found, 0).ranges == ()
    assert withdrawn(found).ranges == ()
    bare = replace(selection, fit=selection.nominal, accepted=())
    assert with_number_ranges(objective, bare) is bare


def test_a_moment_is_stepped_by_less_than_what_begins_takes():
    """A share of a moment would be seconds, or metres: no slope of an edge of 10 ms or 10 mm."""
    begun = [effect for effect in CATALOGUE if effect.onset is not None]
    assert begun
    for effect in begun:
        moment = effect.onset.moment
        for form in effect.onset.forms:
            h = hypothesis(effect, "web", (), (*form, moment))
            values = [
                40.0 if name == moment else a for name, a in zip(h.names, h.start, strict=True)
            ]
            step = h.increments(values)[h.names.index(moment)]
            assert 0.0 < step <= 0.01, effect.name
