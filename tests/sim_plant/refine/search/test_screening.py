"""The first look: which orders of a profile count."""

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.candidate import Candidate, FittedCandidate, bic_penalty
from sim_plant.refine.search.screening import linear_candidate, shortlist, without_failed
from tests.sim_plant.refine.small import fit_of, formula_twin, objective_of, white

SAMPLES = 5334  # 4000 of them are judged
PROFILE = hypothesis(BY_NAME["out_of_round_roll"], "unwind")
OBJECTIVE = objective_of(
    formula_twin(lambda _: np.zeros((1, SAMPLES)), ["unwind_tension_N"], SAMPLES),
    white((1, SAMPLES)),
)
VECTOR = OBJECTIVE.rows + len(OBJECTIVE.nuisances)


def record(sizes, seed=1):
    """Return a residual and orthonormal columns with these sizes in the noise."""
    rng = np.random.default_rng(seed)
    columns = np.zeros((VECTOR, len(PROFILE.names)))
    judged = rng.standard_normal((OBJECTIVE.rows, len(PROFILE.names)))
    columns[: OBJECTIVE.rows] = np.linalg.qr(judged)[0]
    residual = columns @ np.asarray(sizes)
    residual[: OBJECTIVE.rows] += rng.standard_normal(OBJECTIVE.rows)
    return residual, columns


def inner_of(residual, columns):
    return OBJECTIVE.projector.inner(residual, columns)


def test_only_orders_that_pay_are_priced_and_fitted():
    sizes = np.zeros(12)
    sizes[2:4] = 12.0, -9.0
    residual, columns = record(sizes)
    candidate = linear_candidate(OBJECTIVE, PROFILE, inner_of(residual, columns))
    fewer, start = candidate.trimmed()
    assert fewer.names == ("cos2_m", "sin2_m")
    own = columns[:, 2:4].T @ residual
    assert candidate.score == pytest.approx(float(own @ own) - bic_penalty(OBJECTIVE, 2))
    assert candidate.penalty == pytest.approx(2.0 * np.log(1000.0), rel=1e-3)
    assert start == pytest.approx([own[0] * PROFILE.start[2], own[1] * PROFILE.start[3]])
    assert fewer.low == PROFILE.low[2:4]


def test_every_order_that_is_there_is_kept():
    h, start = linear_candidate(OBJECTIVE, PROFILE, inner_of(*record(np.full(12, 15.0)))).trimmed()
    assert h.names == PROFILE.names
    assert len(start) == 12


def test_one_order_is_kept_even_of_noise():
    fewer, _ = linear_candidate(
        OBJECTIVE, PROFILE, inner_of(*record(np.zeros(12), seed=2))
    ).trimmed()
    assert len(fewer.names) == 2


def test_what_cannot_be_simulated_comes_last():
    residual, columns = record(np.zeros(12))
    broken = linear_candidate(OBJECTIVE, PROFILE, inner_of(residual, columns * np.nan))
    assert broken.score == -np.inf


def test_an_effect_is_fitted_at_three_places_at_most_and_a_curved_one_gets_a_second_chance():
    def candidate(effect, place, worth):
        h = hypothesis(BY_NAME[effect], place)
        return Candidate(hypothesis=h, chi2_reduction=worth, penalty=0.0, start=h.start)

    found = [candidate("eccentric_roller", f"R{k}", 1000.0 - k) for k in range(5)]
    found += [
        candidate("bearing_drag", "R6", 300.0),  # drags one way only
        candidate("unbalanced_roller", "R6", 299.0),
        candidate("bearing_drag", "R7", 140.0),
    ]
    kept = [c.hypothesis.key for c in shortlist(found)]
    assert kept == [
        *(EffectAt("eccentric_roller", f"R{k}") for k in range(3)),
        EffectAt("bearing_drag", "R6"),
    ]


def test_beside_half_of_a_pair_a_small_linear_score_excludes_nothing():
    """A ripple of the motor that a roll's first order imitates is left a small part of it."""

    def candidate(effect, worth):
        h = hypothesis(BY_NAME[effect], "unwind")
        return Candidate(hypothesis=h, chi2_reduction=worth, penalty=0.0, start=h.start)

    found = [
        candidate("encoder_eccentricity", 15700.0),
        candidate("torque_ripple", 9200.0),
        candidate("unbalanced_roller", 8500.0),
        candidate("torque_ripple", 300.0),
        candidate("mains_hum", 1.0),
    ]
    names = [c.hypothesis.effect.name for c in shortlist(found, beside_half=True)]
    assert names == ["encoder_eccentricity", "torque_ripple", "unbalanced_roller"]
    assert [c.hypothesis.effect.name for c in shortlist(found)] == names[:1]


def test_a_first_look_whose_fit_gave_no_estimate_is_no_rival():
    drags = [hypothesis(BY_NAME["bearing_drag"], place) for place in ("R1", "R2", "R3")]
    looks = [
        Candidate(hypothesis=h, chi2_reduction=chi2, penalty=0.0, start=h.start)
        for h, chi2 in zip(drags, (300.0, 200.0, 100.0), strict=True)
    ]
    fit = FittedCandidate(fit=fit_of(drags[1]), chi2_reduction=200.0, penalty=0.0)
    left = without_failed(looks, looks[:2], [fit])
    assert [c.hypothesis.location for c in left] == ["R2", "R3"]
