"""Which of several fits is claimed: the rules, with fits made up for them."""

from types import SimpleNamespace

import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search import forward_selection as trace
from sim_plant.refine.search import selection as claim

DRAG = hypothesis(BY_NAME["bearing_drag"], "R3")
FAR_DRAG = hypothesis(BY_NAME["bearing_drag"], "R9")
MODULUS = hypothesis(BY_NAME["web_modulus"], "web")
OBJECTIVE = SimpleNamespace(rows=40_000, expected_cost=40_000.0)
COST = 41_000.0


def found():
    fit = SimpleNamespace(cost=COST, hypotheses=())
    return SimpleNamespace(nominal=fit, fit=fit, before=[[]], travels=[None], steps=[], aside=0.0)


def rival(h, score):
    """Return a fit whose score is this."""
    cost = COST - score - claim.bic_penalty(OBJECTIVE, len(h.names))
    return score, SimpleNamespace(cost=cost, hypotheses=(h,)), h


@pytest.fixture
def missed(monkeypatch):
    """Say what is lost without each effect; return the table to fill."""
    table = {}
    monkeypatch.setattr(
        claim,
        "_missed",
        lambda _, fit: (
            table[fit.hypotheses[-1].key]
            + claim.bic_penalty(OBJECTIVE, len(fit.hypotheses[-1].names))
        ),
    )
    return table


def claimed(rivals):
    return claim.claim(OBJECTIVE, found(), [], lambda _: None, rivals)


def test_a_fit_that_is_not_missed_makes_room_for_the_next(missed):
    missed |= {DRAG.key: 10.0, MODULUS.key: 400.0}
    step, _ = claimed([rival(DRAG, 450.0), rival(MODULUS, 420.0)])
    assert step.hypothesis.key == MODULUS.key
    assert step.score == pytest.approx(400.0)
    assert step.ambiguous == ()


def test_two_that_are_missed_alike_are_both_named(missed):
    missed |= {DRAG.key: 300.0, FAR_DRAG.key: 296.0}
    step, _ = claimed([rival(DRAG, 310.0), rival(FAR_DRAG, 305.0)])
    assert step.ambiguous == (FAR_DRAG.key,)
    assert step.margin == pytest.approx(4.0)


def test_a_weak_one_that_another_explains_as_well_is_no_claim(missed):
    missed |= {DRAG.key: 130.0, FAR_DRAG.key: 126.0}
    assert claimed([rival(DRAG, 130.0), rival(FAR_DRAG, 126.0)]) is None
    step, _ = claimed([rival(DRAG, 130.0)])
    assert step.hypothesis.key == DRAG.key


def test_what_has_no_line_of_its_own_needs_more(missed):
    missed |= {DRAG.key: 100.0}
    assert claimed([rival(DRAG, 100.0)]) is None


def test_the_least_of_a_large_explanation_grows_with_it(missed):
    missed |= {DRAG.key: 500.0}
    large = found()
    large.nominal = SimpleNamespace(cost=COST + 1e5)
    assert claim.claim(OBJECTIVE, large, [], lambda _: None, [rival(DRAG, 500.0)]) is None


def test_what_a_strong_free_term_leaves_is_no_effect(missed):
    beside = found()
    beside.aside = 5e5  # a flat spot that no effect explains; 0.1 % of it is 500
    missed |= {DRAG.key: 450.0}
    assert claim.claim(OBJECTIVE, beside, [], lambda _: None, [rival(DRAG, 450.0)]) is None
    missed |= {DRAG.key: 550.0}
    assert claim.claim(OBJECTIVE, beside, [], lambda _: None, [rival(DRAG, 550.0)]) is not None


@pytest.mark.parametrize(
    ("explained", "left", "ended"),
    [
        (649.0, -470.0, False),  # noise of 40 000 rows is known to 283: a weak line may be left
        (1e6, 3000.0, True),  # 0.6 % of what a strong effect explained
        (1e6, 7000.0, False),
    ],
)
def test_the_search_ends_when_what_is_left_is_surely_no_effect(explained, left, ended):
    cost = OBJECTIVE.expected_cost + left
    state = SimpleNamespace(
        fit=SimpleNamespace(cost=cost), nominal=SimpleNamespace(cost=cost + explained)
    )
    assert trace._at_floor(OBJECTIVE, state) is ended


def test_an_effect_that_explains_less_than_half_of_a_pair_does_not_take_its_place(monkeypatch):
    """Roll bounce, complete at its one line, against a flat spot that a delay has turned."""
    flat = hypothesis(BY_NAME["out_of_round_roll"], "unwind")
    bounce = hypothesis(BY_NAME["roll_bounce"], "unwind")
    state = SimpleNamespace(cost=1e6, hypotheses=())
    now = SimpleNamespace(fit=state, after=[[]], travels=[None], steps=[], nominal=state)

    def fit_of(*hypotheses, cost):
        return SimpleNamespace(cost=cost, hypotheses=hypotheses)

    best = {
        flat.key: (SimpleNamespace(hypothesis=flat), fit_of(flat, cost=2e5)),
        bounce.key: (SimpleNamespace(hypothesis=bounce), fit_of(bounce, cost=6e5)),
    }
    monkeypatch.setattr(trace, "with_line_support", lambda *_: ([flat, bounce], []))
    monkeypatch.setattr(trace, "_beyond_tolerance", lambda *_: [])
    monkeypatch.setattr(trace, "is_line", lambda *_: True)
    monkeypatch.setattr(
        trace, "_best_of", lambda _p, _f, group, *_: best[group[0].key] if group else None
    )
    monkeypatch.setattr(
        trace, "explains_own_lines", lambda _p, _b, _a, _t, fit: flat not in fit.hypotheses
    )
    tried = []
    monkeypatch.setattr(trace, "_beside", lambda _p, _f, half, *_: tried.append(half))
    assert trace._search(OBJECTIVE, now, [flat, bounce], lambda _: None) is None
    assert tried == [best[flat.key]]
