"""What a record says of a declared number by itself, whatever tolerance it was given."""

from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.gauss_newton import gauss_newton_fit, nominal_fit
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.candidate import fitted_candidate
from sim_plant.refine.search.completeness import remaining_spectra
from sim_plant.refine.search.forward_selection import best_of
from sim_plant.refine.search.outside_prior import (
    beyond_tolerance,
    chi2_by_records,
    ending_conflict,
    starts_outside_prior,
)
from sim_plant.refine.search.selection import Selection
from tests.sim_plant.refine.small import (
    axes_at,
    fit_of,
    formula_twin,
    line_with,
    objective_of,
    quiet,
    white,
)

IDLERS = [f"R{k}" for k in range(1, 9)]
FRICTION_N_M, RADIUS_M = 0.017219, 0.0381

SAMPLES, JUDGED = 6000, 4500
MODULUS = hypothesis(BY_NAME["web_modulus"], "web")
RIPPLE = hypothesis(BY_NAME["torque_ripple"], "unwind")
WAVE = np.sign(np.sin(2.0 * np.pi * np.arange(SAMPLES) / 300.0))
NEWTON = 40.0
"""Of tension per relative change of the modulus: 10 % is 4 standard deviations of noise."""


def response(case):
    """Return one tension: what the modulus does, as an effect or as a shifted number."""
    change = sum(shift for name, shift in case.shifts if name == "web.EA_N")
    change += sum(
        dict(e.parameters)["factor"] - 1.0 for e in case.effects if e.effect == "web_modulus"
    )
    return NEWTON * change * WAVE[None, :]


@pytest.mark.parametrize("tolerance", [0.002, 0.02])
def test_the_record_says_as_much_whatever_the_tolerance(tolerance):
    line = line_with({"*": 0.0, "web.EA_N": tolerance})
    twin = formula_twin(response, ["unwind_tension_N"], SAMPLES, line=line)
    objective = objective_of(twin, NEWTON * 0.1 * WAVE[None, :] + white((1, SAMPLES)))
    fit = gauss_newton_fit(objective, (MODULUS,), (MODULUS.start,), {})
    assert fit.values[0][0] == pytest.approx(1.1, abs=0.002)
    whole = objective.whitened([NEWTON * 0.1 * WAVE[None, :]])  # no other number answers alike
    assert chi2_by_records(objective, fit) == pytest.approx(float(whole @ whole), rel=0.05)
    assert whole @ whole > 0.5 * JUDGED * (NEWTON * 0.1) ** 2  # noise takes up some of the wave


def test_of_an_effect_that_is_no_declared_number_nothing_is_told():
    twin = formula_twin(response, ["unwind_tension_N"], SAMPLES)
    objective = objective_of(twin, white((1, SAMPLES)))
    assert chi2_by_records(objective, fit_of(RIPPLE)) == 0.0


def test_a_number_that_a_fit_has_moved_starts_as_its_effect_with_all_else_as_fitted():
    """There the two are one simulation: nothing else has to be found again."""
    line = line_with({"*": 0.0, "web.EA_N": 0.002, "web.thickness_m": 0.01})
    twin = formula_twin(response, ["unwind_tension_N"], SAMPLES, line=line)
    objective = objective_of(twin, NEWTON * 0.1 * WAVE[None, :] + white((1, SAMPLES)))
    moved = {"web.EA_N": 0.1, "web.thickness_m": 0.003}
    fit = gauss_newton_fit(objective, (), (), moved, rounds=0)
    starts = starts_outside_prior(objective, fit, {"web_modulus"})
    (h, first, kept), (_, second, declared) = starts
    assert (h.key.effect, first, kept) == ("web_modulus", (1.1,), {"web.thickness_m": 0.003})
    assert 1.05 < second[0] < 1.1  # a tolerance pulls it back
    assert declared == {}
    as_effect = gauss_newton_fit(objective, (h,), (first,), kept, rounds=0)
    assert np.allclose(objective.pool.one(as_effect.case)[0], objective.pool.one(fit.case)[0])
    assert as_effect.cost < fit.cost - 1000.0  # the price of a tolerance of 0.1 %, 100 times over


@pytest.mark.parametrize(("change", "outside"), [(0.03, False), (0.037, False), (0.043, True)])
def test_a_number_is_beyond_its_tolerance_where_its_whole_interval_is(change, outside):
    """2 % of tolerance are one standard deviation of 1 %: 95 % reach to 1.96 % on either side."""
    line = line_with({"*": 0.0, "web.EA_N": 0.02})
    twin = formula_twin(response, ["unwind_tension_N"], SAMPLES, line=line)
    objective = objective_of(twin, NEWTON * change * WAVE[None, :] + white((1, SAMPLES)))
    fit = gauss_newton_fit(objective, (MODULUS,), (MODULUS.start,), {})
    assert fit.values[0][0] - 1.0 == pytest.approx(change, abs=0.002)
    assert beyond_tolerance(objective, fit) is outside
    assert not beyond_tolerance(objective, fit_of(RIPPLE))


@pytest.mark.parametrize(("factor", "told"), [(1.08, True), (0.94, True), (1.03, False)])
def test_a_modulus_beyond_its_tolerance_is_told_though_it_gains_no_120(factor, told):
    """Of 8 % it gains the square of 8 standard deviations, 64, less the price of a number."""
    line = line_with({"*": 0.0, "web.EA_N": 0.02})
    twin = formula_twin(response, ["unwind_tension_N"], SAMPLES, line=line)
    change_N = NEWTON * (factor - 1.0) * WAVE[None, :]
    objective = objective_of(twin, change_N + white((1, SAMPLES)))
    nominal = nominal_fit(objective)
    axes = (axes_at(np.ones(JUDGED)),)
    left = remaining_spectra(objective, nominal, axes)
    nothing = Selection(
        nominal=nominal, fit=nominal, record_axes=axes, spectra_declared=left, spectra_left=left
    )
    found = best_of(objective, nothing, [MODULUS], quiet)
    assert (found is not None) is told
    if found is not None:
        assert found.fit.values[0][0] == pytest.approx(factor, abs=0.002)
        z = (factor - 1.0) / 0.01
        assert found.accepted.score == pytest.approx(z**2 - np.log(JUDGED / 4.0), abs=2.0)


def braked(case):
    """Return a tension that any of eight idlers' bearings lowers alike."""
    change = sum(
        shift * FRICTION_N_M for name, shift in case.shifts if "friction_constant" in name
    )
    change += sum(dict(e.parameters)["constant_N_m"] for e in case.effects)
    return change / RADIUS_M * WAVE[None, :]


@pytest.mark.parametrize(("drag_N_m", "ends_conflict"), [(0.11, True), (0.02, False)])
def test_a_drag_that_like_idlers_stand_in_for_settles_what_their_tolerances_are_not(
    drag_N_m, ends_conflict
):
    numbers = {f"rollers.{r}.friction_constant_N_m": 0.3 for r in IDLERS}
    line = line_with({**numbers, "*": 0.0})
    twin = formula_twin(braked, ["unwind_tension_N"], SAMPLES, line=line)
    size_N = drag_N_m / RADIUS_M
    objective = objective_of(twin, size_N * WAVE[None, :] + white((1, SAMPLES)))
    base = gauss_newton_fit(objective, (), (), {})
    drag = hypothesis(BY_NAME["bearing_drag"], "R6", line=line)
    fit = gauss_newton_fit(objective, (drag,), ((0.05,),), {})
    candidate = fitted_candidate(objective, base, fit)
    alone = chi2_by_records(objective, fit)
    # own: what seven others share costs z^2 / 7, z in half tolerances of one, with noise beside
    z = fit.values[0][0] / (0.5 * 0.3 * FRICTION_N_M)
    assert alone == pytest.approx(z**2 / 7.0, rel=0.1)
    assert alone < 400.0
    candidate = replace(candidate, chi2_by_records=alone, chi2_reduction=300.0)
    (found,) = ending_conflict(objective, base, [candidate])
    assert found.ends_conflict is ends_conflict
    whole = objective.whitened([fit.values[0][0] / RADIUS_M * WAVE[None, :]])
    shown = float(whole @ whole) if ends_conflict else alone  # none of the seven counts then
    assert found.chi2_by_records == pytest.approx(shown, rel=0.05)
    (other,) = ending_conflict(objective, base, [replace(candidate, chi2_by_records=0.0)])
    assert other.ends_conflict is False  # no declared number is there to be told from it
