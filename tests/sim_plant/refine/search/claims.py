"""Fits made up for the rules of what is claimed."""

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.candidate import FittedCandidate
from sim_plant.refine.search.selection import AcceptedEffect, Selection, accept, confirmed_scores
from tests.sim_plant.refine.small import fit_of, one_peak, quiet

DRAG = hypothesis(BY_NAME["bearing_drag"], "R3")
FAR_DRAG = hypothesis(BY_NAME["bearing_drag"], "R9")
MODULUS = hypothesis(BY_NAME["web_modulus"], "web")
COST, PENALTY = 41_000.0, 10.0


def selection(cost=COST, nominal=None, **more):
    return Selection(
        nominal=fit_of(cost=cost if nominal is None else nominal),
        fit=fit_of(cost=cost),
        record_axes=(),
        spectra_declared=one_peak(),
        spectra_left=one_peak(),
        **more,
    )


def rival(h, worth, chi2_by_records=0.0, ends_conflict=False, beyond_tolerance=False):
    """Return a fit whose score is this, and what the record alone says of it."""
    fit = fit_of(h, cost=COST - worth - PENALTY)
    return FittedCandidate(
        fit=fit,
        chi2_reduction=COST - fit.cost,
        penalty=PENALTY,
        chi2_by_records=chi2_by_records,
        ends_conflict=ends_conflict,
        beyond_tolerance=beyond_tolerance,
    )


def claimed(rivals, missed, found=None):
    """Return what is accepted, given the score that each effect keeps when it is taken out."""
    found = found or selection()

    def chi2_without(fit):
        return missed[fit.hypotheses[-1].key] + PENALTY

    return accept(found, confirmed_scores(found, rivals, chi2_without, quiet), [], quiet)


def found_first(name, place):
    h = hypothesis(BY_NAME[name], place)
    there = AcceptedEffect(hypothesis=h, score=1e4, runner_up=None, margin=1e4, rejected=())
    return selection(accepted=(there,))
