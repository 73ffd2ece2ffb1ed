"""What the effects found leave: its class, and whether they imitate what is not there."""

from __future__ import annotations

from dataclasses import replace

from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.search.selection import Selection, imitates
from sim_plant.refine.search.set_apart import set_apart, wander_of
from sim_plant.refine.search.unexplained import Unknown, what_is_left


def classified(objective: Objective, selection: Selection) -> Selection:
    """Return the selection with the class of what is left, slow changes of effects apart.

    What is left beside a strong effect is looked at for an imitation as an effect is accepted
    there: apart from the strong one's own spectral lines, at which its model error lies.
    """
    wander = wander_of(objective, selection)
    apart = set_apart(objective, selection, at_spectral_lines=False, wander=wander)
    weigh, seen = (objective, selection) if apart is None else (apart.objective, apart.selection)
    fit = seen.fit
    unknown = what_is_left(weigh, selection.nominal, fit, selection.record_axes, seen.spectra_left)
    nominal_excess = selection.nominal.cost - objective.expected_cost
    excess = weigh.excess(fit.cost, fit.residual)
    if not unknown and imitates(selection.accepted, excess, nominal_excess):
        apart = set_apart(objective, selection, at_spectral_lines=True, wander=wander)
        if apart is not None:
            fit = apart.selection.fit
            excess = apart.objective.excess(fit.cost, fit.residual)
        if imitates(selection.accepted, excess, nominal_excess):
            unknown = [Unknown(unknown_class="broadband", chi2_reduction=excess, coordinate={})]
    return replace(selection, unknown=tuple(unknown))
