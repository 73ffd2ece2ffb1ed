"""The first look: which orders of a profile count."""

from types import SimpleNamespace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.projection import Projector
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.screening import bic_penalty, every_third_idler, linear_candidate

ROWS = 4000
PROFILE = hypothesis(BY_NAME["out_of_round_roll"], "unwind")


def record(sizes, seed=1):
    """Return a problem, its residual and orthonormal columns with these sizes in the noise."""
    rng = np.random.default_rng(seed)
    columns, _ = np.linalg.qr(rng.standard_normal((ROWS, len(PROFILE.names))))
    residual = columns @ np.asarray(sizes) + rng.standard_normal(ROWS)
    objective = SimpleNamespace(projector=Projector(np.zeros((ROWS, 1))), rows=ROWS)
    return objective, residual, columns


def test_only_orders_that_pay_are_priced_and_fitted():
    sizes = np.zeros(12)
    sizes[2:4] = 12.0, -9.0
    objective, residual, columns = record(sizes)
    candidate = linear_candidate(objective, PROFILE, residual, columns)
    fewer, start = candidate.trimmed()
    assert fewer.names == ("cos2_m", "sin2_m")
    own = columns[:, 2:4].T @ residual
    assert candidate.score == pytest.approx(float(own @ own) - bic_penalty(objective, 2))
    assert start == pytest.approx([own[0] * PROFILE.start[2], own[1] * PROFILE.start[3]])
    assert fewer.low == PROFILE.low[2:4]


def test_every_order_that_is_there_is_kept():
    objective, residual, columns = record(np.full(12, 15.0))
    h, start = linear_candidate(objective, PROFILE, residual, columns).trimmed()
    assert h.names == PROFILE.names
    assert len(start) == 12


def test_one_order_is_kept_even_of_noise():
    objective, residual, columns = record(np.zeros(12), seed=2)
    fewer, _ = linear_candidate(objective, PROFILE, residual, columns).trimmed()
    assert len(fewer.names) == 2


def test_no_load_cell_and_no_idler_of_a_short_line_is_left_out():
    names = [f"R{k}" for k in range(12)]
    hums = [hypothesis(BY_NAME["mains_hum"], name) for name in names]
    drags = [hypothesis(BY_NAME["bearing_drag"], name) for name in names]
    assert every_third_idler(hums, names) == hums
    assert every_third_idler(drags[:5], [*names[:5], ""]) == drags[:5]
    assert [h.location for h in every_third_idler(drags, names)] == ["R1", "R4", "R7", "R10"]
