"""Beside strong spectral lines: what an effect without any explains apart from those lines.

No model is exact: it leaves some per mille of what a strong effect does. But it leaves them where
that effect shows, at its own spectral lines. So an effect that has none is judged on what remains
when those lines are free in size and phase in every channel, and change with speed and slowly
with time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.gauss_newton import Fit, gauss_newton_fit
from sim_plant.refine.fit.objective import Objective, conditioned_on
from sim_plant.refine.search.candidate import FittedCandidate, sure_fall
from sim_plant.refine.search.completeness import explains_own_spectral_lines, remaining_spectra
from sim_plant.refine.search.free_terms import free_term_basis
from sim_plant.refine.search.selection import Selection
from sim_plant.refine.search.unexplained import Unknown
from sim_plant.refine.spectra.coordinates import orders_of, shown_Hz

ACCEPTANCE = CRITERIA.search.acceptance


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Apart:
    """A selection as it is judged apart from the spectral lines of its own effects.

    Attributes
    ----------
    objective : those lines are free terms.
    selection : the same effects and numbers, weighed by it.
    """

    objective: Objective
    selection: Selection

    def weighed(self, fit: Fit, quick: bool = True) -> Fit:
        """Return the fit with what it leaves apart from the lines; no number is moved."""
        return _weighed(self.objective, fit, quick)

    def judged(self, candidate: FittedCandidate) -> FittedCandidate:
        """Return a candidate by what it explains apart from the lines."""
        left = self.weighed(candidate.fit)
        fall = sure_fall(self.objective, self.selection.fit, left)
        return replace(candidate, chi2_reduction=fall)

    def explains_own_spectral_lines(self, fit: Fit) -> bool:
        """Return whether ``fit`` explains a fair share of what is left apart from the lines."""
        base = self.selection
        return explains_own_spectral_lines(
            self.objective, base.fit, base.after, base.travels, self.weighed(fit)
        )


def apart_from_spectral_lines(objective: Objective, selection: Selection) -> Apart | None:
    """Return the selection as judged apart from its effects' spectral lines.

    None where that decides nothing: no effect has a line, they explain too little for their
    model error to hide another, or free terms are there already.
    """
    explained = selection.nominal.cost - selection.fit.cost
    lines = own_spectral_lines(selection)
    free = any(terms is not None for terms in objective.whitening.basis)
    if free or not lines or ACCEPTANCE.explained_share * explained <= ACCEPTANCE.score:
        return None
    basis = [free_term_basis(lines, travel) for travel in selection.travels]
    conditioned = conditioned_on(objective, basis)
    fit = _weighed(conditioned, selection.fit, quick=False)
    there = replace(
        selection,
        nominal=_weighed(conditioned, selection.nominal, quick=False),
        fit=fit,
        after=remaining_spectra(conditioned, fit, selection.travels),
    )
    return Apart(objective=conditioned, selection=there)


def own_spectral_lines(selection: Selection) -> Sequence[Unknown]:
    """Return where the accepted effects show: all orders of a body, or a line in time."""
    bodies = [roller.name for roller in selection.travels[0].declaration.rollers]
    lines: list[Unknown] = []
    for accepted in selection.accepted:
        h = accepted.hypothesis
        in_time = shown_Hz(h, selection.travels[0])
        if in_time is not None:
            lines.append(_line("time", {"frequency_Hz": in_time}))
        elif orders_of(h, 1.0) and h.location in bodies:
            lines.append(_line("angle", {"roll": h.location, "order": 1.0}))
    return lines


def _line(kind: str, coordinate: dict[str, float | str]) -> Unknown:
    return Unknown(kind=kind, coordinate=coordinate, strength=0.0)


def _weighed(objective: Objective, fit: Fit, quick: bool) -> Fit:
    there = gauss_newton_fit(
        objective, fit.hypotheses, fit.values, fit.shifts, rounds=0, quick=quick
    )
    return replace(fit, cost=there.cost, residual=there.residual)
