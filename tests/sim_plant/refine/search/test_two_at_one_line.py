"""Two rollers of one radius that are wrong in two ways: no one of them explains their line."""

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.twin import Case
from sim_plant.refine.search.completeness import leaves_much
from sim_plant.refine.search.one_more import best_of, explains_own_lines
from sim_plant.refine.search.two_at_one_line import two_at_one_line
from tests.sim_plant.refine.search.rollers import KINDS, LINE, nothing_found, of_kind, put, seen
from tests.sim_plant.refine.small import quiet

HIDDEN = (
    put(of_kind("eccentric_roller", "R1"), 3.0, 1.0),
    put(of_kind("unbalanced_roller", "R6"), 0.6, -3.1),
)
TWO = {of_kind("eccentric_roller", "R1").key, of_kind("unbalanced_roller", "R6").key}


def test_an_eccentric_and_an_unbalanced_roller_of_one_radius_are_found_together():
    objective, selection = nothing_found(HIDDEN)
    half = best_of(objective, selection, KINDS, quiet)
    assert half.hypothesis.location == "R4"  # between them, and neither
    assert not explains_own_lines(objective, selection, half.fit)
    found = two_at_one_line(objective, selection, half, [], KINDS, quiet)
    assert {e.hypothesis.key for e in found} == TWO
    fit = found[-1].fit
    for h, values in zip(fit.hypotheses, fit.values, strict=True):
        true = next(a for a in HIDDEN if a.effect == h.effect.name)
        assert values == pytest.approx([v for _, v in true.parameters], rel=0.1)
    for e in found:  # each is told with what else may be there, best first
        scores = [score for _, score in e.accepted.rejected]
        assert scores == sorted(scores, reverse=True)
        assert e.accepted.runner_up == e.accepted.rejected[0][0]
        assert e.accepted.margin > 0.0


def test_two_of_one_kind_are_found_together_where_one_between_explains_most():
    hidden = (
        put(of_kind("eccentric_roller", "R1"), 3.0, 1.0),
        put(of_kind("eccentric_roller", "R6"), 0.6, -3.1),
    )
    objective, selection = nothing_found(hidden)
    half = best_of(objective, selection, KINDS, quiet)
    found = two_at_one_line(objective, selection, half, [], KINDS, quiet)
    assert {(e.hypothesis.effect.name, e.hypothesis.location) for e in found} == {
        ("eccentric_roller", "R1"),
        ("eccentric_roller", "R6"),
    }


def test_what_has_no_line_and_leaves_much_takes_no_place_of_two_rollers():
    """It mends the half by what half leaves, much of that put into the wrong cell."""
    objective, selection = nothing_found(HIDDEN)
    half = best_of(objective, selection, KINDS, quiet)
    left = seen(Case(effects=HIDDEN)) - seen(Case(effects=half.fit.effects))
    mends = left + 0.6 * left[::-1] * [[1.0], [0.0], [-1.0]]
    drag = hypothesis(BY_NAME["bearing_drag"], "R3", line=LINE)

    def with_mending(case):
        rolling = [e for e in case.effects if e.effect != "bearing_drag"]
        sizes = [dict(e.parameters)["constant_N_m"] for e in case.effects if e not in rolling]
        return seen(Case(effects=tuple(rolling))) + sum(sizes) / drag.start[0] * mends

    objective, selection = nothing_found(HIDDEN, with_mending)
    half = best_of(objective, selection, KINDS, quiet)
    (alone,) = {
        e.hypothesis.key
        for e in two_at_one_line(objective, selection, half, [drag], [half.hypothesis], quiet)
    } - {half.hypothesis.key}
    assert alone == drag.key  # without a rival it is taken ...
    beside = two_at_one_line(objective, selection, half, [drag], [half.hypothesis], quiet)
    assert leaves_much(objective, selection.fit, beside[-1].fit)
    found = two_at_one_line(objective, selection, half, [drag], KINDS, quiet)
    assert {e.hypothesis.key for e in found} == TWO  # ... beside them not
    assert not leaves_much(objective, selection.fit, found[-1].fit)


def test_a_roller_that_is_alone_has_no_second():
    objective, selection = nothing_found(HIDDEN[:1])
    half = best_of(objective, selection, KINDS, quiet)
    assert half.hypothesis.key in TWO
    assert explains_own_lines(objective, selection, half.fit)
    assert np.isfinite(half.fit.cost)
    assert two_at_one_line(objective, selection, half, [], KINDS[:1], quiet) == ()
