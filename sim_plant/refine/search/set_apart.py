"""Judge a weak effect beside strong ones, after removing the model error of the strong ones.

No model is exact: some per mille of what a strong effect does remain in the residual. That error
lies at the strong effect's own spectral lines. So an effect without a spectral line is judged on
the residual that remains when the lines of the effects already found are free terms: free in size
and phase in every channel, changing with speed and slowly with time. And where the size of an
effect is not quite constant, any other effect is judged after that size was allowed to wander.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective, conditioned_on, with_wander
from sim_plant.refine.fit.start_states import Changes
from sim_plant.refine.search.candidate import FittedCandidate, sure_fall
from sim_plant.refine.search.completeness import explains_own_spectral_lines, remaining_spectra
from sim_plant.refine.search.free_terms import free_term_basis
from sim_plant.refine.search.selection import AcceptedEffect, Selection
from sim_plant.refine.search.unexplained import Unknown
from sim_plant.refine.search.wandering import wander_changes
from sim_plant.refine.spectra.coordinates import orders_of, shown_Hz

ACCEPTANCE = CRITERIA.search.acceptance
LOW_ORDERS = CRITERIA.search.free_terms.harmonics["angle"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class JudgedApart:
    """A selection, judged apart from the model error of its effects.

    Attributes
    ----------
    objective : their spectral lines are free terms, and so are slow changes of their sizes.
    selection : the same effects and numbers, judged by it.
    """

    objective: Objective
    selection: Selection

    def re_evaluated_fit(self, fit: Fit, quick: bool = True) -> Fit:
        """Return the fit with its cost and residual under ``objective``, nothing fitted again.

        ``quick``: simulated with the longer drive tick, for differences between fits.
        """
        return _under(self.objective, fit, quick)

    def re_evaluated_candidate(self, candidate: FittedCandidate) -> FittedCandidate:
        """Return a candidate by what it explains under ``objective``."""
        fit_apart = self.re_evaluated_fit(candidate.fit)
        explained = sure_fall(self.objective, self.selection.fit, fit_apart)
        return replace(candidate, chi2_reduction=explained)

    def explains_own_spectral_lines(self, fit: Fit) -> bool:
        """Return whether ``fit`` explains a fair share of what is left apart from the lines."""
        base = self.selection
        return explains_own_spectral_lines(
            self.objective,
            base.fit,
            base.spectra_left,
            base.record_axes,
            self.re_evaluated_fit(fit),
        )


def set_apart(
    objective: Objective,
    selection: Selection,
    *,
    at_spectral_lines: bool,
    wander: Sequence[Changes] | None = None,
) -> JudgedApart | None:
    """Return the selection, judged apart from the model error of its effects.

    ``at_spectral_lines``: their spectral lines are free terms as well. ``wander``: the result of
    ``wander_of``; simulated here where it is not given. None where that decides nothing: their
    model error is too small to hide another effect.
    """
    with_free_lines = (
        apart_from_spectral_lines(objective, selection) if at_spectral_lines else None
    )
    target = objective if with_free_lines is None else with_free_lines
    if wander is None:
        wander = wander_of(objective, selection)
    if wander:
        target = with_wander(target, wander)
    if target is objective:
        return None
    fit = _under(target, selection.fit, quick=False)
    judged = replace(
        selection,
        nominal=_under(target, selection.nominal, quick=False),
        fit=fit,
        spectra_left=remaining_spectra(target, fit, selection.record_axes),
        wander_is_free=bool(wander),
    )
    return JudgedApart(objective=target, selection=judged)


def wander_of(objective: Objective, selection: Selection) -> list[Changes]:
    """Return what changes as the sizes of effects wander, one term per pair of intervals."""
    indices = [k for k, accepted in enumerate(selection.accepted) if has_large_wander(accepted)]
    return [change for k in indices for change in wander_changes(objective.pool, selection.fit, k)]


def apart_from_spectral_lines(objective: Objective, selection: Selection) -> Objective | None:
    """Return the objective with the spectral lines of what was found as free terms.

    None where no effect has a spectral line, where effects explain too little for their model
    error to hide another, or where free terms are there already.
    """
    explained = selection.nominal.cost - selection.fit.cost
    spectral = own_spectral_lines(selection)
    free = any(terms is not None for terms in objective.whitening.basis)
    if free or not spectral or ACCEPTANCE.explained_share * explained <= ACCEPTANCE.score:
        return None
    basis = [free_term_basis(spectral, axes) for axes in selection.record_axes]
    return conditioned_on(objective, basis)


def has_large_wander(found: AcceptedEffect) -> bool:
    """Return whether the size of an effect changes by more than may hide another."""
    return found.hypothesis.effect.wander * found.score > ACCEPTANCE.score


def own_spectral_lines(selection: Selection) -> Sequence[Unknown]:
    """Return spectral lines of the accepted effects: the orders of a body, or a frequency.

    Of a body all low orders (one line of order 1: the free terms take those up to ``LOW_ORDERS``
    with it), and each order of the effect that is not among them: a fine one, or one that is not
    whole. The fine ones of a profile are its own and are left.
    """
    bodies = [roller.name for roller in selection.record_axes[0].declaration.rollers]
    spectral: list[Unknown] = []
    for accepted in selection.accepted:
        h = accepted.hypothesis
        in_time = shown_Hz(h, selection.record_axes[0])
        if in_time is not None:
            spectral.append(_spectral_line("time", {"frequency_Hz": in_time}))
        elif orders_of(h, 1.0) and h.location in bodies:
            spectral.append(_spectral_line("angle", {"roll": h.location, "order": 1.0}))
            roller = selection.record_axes[0].declaration.rollers[bodies.index(h.location)]
            spectral += [
                _spectral_line("angle", {"roll": h.location, "order": order})
                for order in orders_of(h, roller.radius_m)
                if h.effect.profiles is None and not (order.is_integer() and order <= LOW_ORDERS)
            ]
    return spectral


def _spectral_line(axis: str, coordinate: dict[str, float | str]) -> Unknown:
    return Unknown(unknown_class=axis, coordinate=coordinate, chi2_reduction=0.0)


def _under(objective: Objective, fit: Fit, quick: bool) -> Fit:
    """Return the fit with the cost and residual that it has under ``objective``."""
    again = gauss_newton_fit(
        objective, fit.hypotheses, fit.values, fit.shifts, rounds=0, quick=quick
    )
    return replace(fit, cost=again.cost, residual=again.residual)
