"""When the same effect at two other places says as much as one place."""

from types import SimpleNamespace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.projection import Projector
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search import degenerate_pair as two_places
from sim_plant.refine.search.degenerate_pair import better_pair
from sim_plant.refine.search.screening import Candidate, bic_penalty

ROWS = 4000
RADII_M = {"R1": 0.04, "R2": 0.04, "R3": 0.04, "R4": 0.05}
BODIES = list(RADII_M)
LINE = SimpleNamespace(
    body=BODIES.index, rollers=[SimpleNamespace(radius_m=RADII_M[name]) for name in BODIES]
)
TRAVEL = SimpleNamespace(declaration=LINE)
BASIS = np.linalg.qr(np.random.default_rng(5).standard_normal((ROWS, 4)))[0]
ANSWERS = {  # R2 answers nearly as the mean of R1 and R3, R4 as R1
    "R1": BASIS[:, :2],
    "R3": BASIS[:, 2:],
    "R2": 0.5 * (BASIS[:, :2] + BASIS[:, 2:]),
    "R4": BASIS[:, :2],
}


def unbalanced(place):
    return hypothesis(BY_NAME["unbalanced_roller"], place)


def instead(monkeypatch, residual, chosen="R2", places=("R1", "R2", "R3", "R4")):
    objective = SimpleNamespace(
        projector=Projector(np.zeros((ROWS, 1))),
        rows=ROWS,
        pool=SimpleNamespace(one=lambda _: None),
        residual=lambda *_: residual,
    )
    monkeypatch.setattr(
        two_places, "sensitivities", lambda _p, _f, hs: [ANSWERS[h.location] for h in hs]
    )
    ranked = []
    for place in places:
        gain = objective.projector.gain(residual, ANSWERS[place])
        ranked.append(
            Candidate(
                hypothesis=unbalanced(place),
                gain=gain,
                start=(0.0, 0.0),
                score=gain.chi2_reduction - bic_penalty(objective, 2),
            )
        )
    ranked.sort(key=lambda s: -s.score)
    fit = SimpleNamespace(case=None, shifts={})
    return better_pair(objective, fit, TRAVEL, unbalanced(chosen), ranked)


def noise(seed=1):
    return np.random.default_rng(seed).standard_normal(ROWS)


def test_two_of_one_radius_that_explain_more_are_named(monkeypatch):
    residual = ANSWERS["R1"] @ [25.0, 3.0] + ANSWERS["R3"] @ [15.0, 9.0] + noise()
    found = instead(monkeypatch, residual)
    assert set(found) == {("unbalanced_roller", "R1"), ("unbalanced_roller", "R3")}


@pytest.mark.parametrize("seed", range(10))
def test_two_that_imitate_one_do_not_pay_for_their_numbers(monkeypatch, seed):
    residual = ANSWERS["R2"] @ [40.0, 12.0] + noise(seed)
    assert instead(monkeypatch, residual) == ()


def test_a_roller_of_another_radius_is_no_alternative(monkeypatch):
    residual = ANSWERS["R1"] @ [25.0, 3.0] + ANSWERS["R3"] @ [15.0, 9.0] + noise()
    assert instead(monkeypatch, residual, places=("R2", "R3", "R4")) == ()


def test_an_effect_that_came_by_another_way_has_no_alternative(monkeypatch):
    residual = ANSWERS["R1"] @ [25.0, 3.0] + ANSWERS["R3"] @ [15.0, 9.0] + noise()
    assert instead(monkeypatch, residual, places=("R1", "R3")) == ()
