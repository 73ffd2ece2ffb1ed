"""One round of the search, its steps replaced by what they would return."""

from types import SimpleNamespace

import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search import forward_selection

NOISE, COST = 1000.0, 21000.0


def round_where_a_periodic_effect_leaves(cost, monkeypatch):
    """Return how often declared numbers were fitted as effects, and what the round returns."""
    periodic = hypothesis(BY_NAME["eccentric_roller"], "R1")
    other = hypothesis(BY_NAME["bearing_drag"], "R1")
    found = SimpleNamespace(fit=SimpleNamespace(cost=cost), hypothesis=periodic)
    fitted = []

    def best_of(objective, selection, group, *rest, **more):
        return found if periodic in group else None

    steps = {
        "with_aliases": lambda library, *rest: library,
        "with_orders": lambda library, *rest: library,
        "by_periodic_chi2": lambda *rest: ([periodic], [other]),
        "wander_of": lambda *rest: (),
        "set_apart": lambda *rest, **more: None,
        "later_score": lambda *rest: 0.0,
        "least_beside": lambda *rest: 0.0,
        "event_candidates": lambda *rest: [],
        "looked_from": lambda fit, apart: fit,
        "best_of": best_of,
        "explains_own_lines": lambda *rest: True,
        "preferred": lambda complete, partial: (complete[0], True),
        "fit_conflicts": lambda *rest: fitted.append(rest) or [],
    }
    for name, step in steps.items():
        monkeypatch.setattr(forward_selection, name, step)
    fit = SimpleNamespace(cost=COST, shifts={})
    selection = SimpleNamespace(fit=fit, accepted=(), record_axes=(), spectra_left=())
    objective = SimpleNamespace(expected_cost=NOISE)
    extensions = forward_selection.next_extensions(
        objective, selection, [periodic, other], lambda _: None
    )
    return len(fitted), extensions == (found,)


@pytest.mark.parametrize(("margin", "times"), [(0.01, 0), (-0.01, 1)])
def test_declared_numbers_are_fitted_as_effects_only_where_no_spectral_line_decides(
    margin, times, monkeypatch
):
    explained = (CRITERIA.search.acceptance.decisive_share + margin) * (COST - NOISE)
    assert round_where_a_periodic_effect_leaves(COST - explained, monkeypatch) == (times, True)
