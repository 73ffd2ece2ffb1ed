from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.load import load_declaration
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.fit.projection import Projector
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search import profile_detail as details

LINE = load_declaration(Path(__file__).parents[4] / "config/lines/euclid.yaml")
ROWS = 400
TIME = np.linspace(0.0, 1.0, ROWS)
SIZE, GROWTH = np.sin(40.0 * TIME), TIME * np.sin(40.0 * TIME)


@pytest.fixture
def objective():
    return SimpleNamespace(
        rows=ROWS,
        projector=Projector(np.zeros((ROWS, 1))),
        split=lambda vector: [np.reshape(vector, (1, ROWS))],
    )


def fit_of(residual):
    h = hypothesis(
        BY_NAME["out_of_round_roll"], "unwind", (("shape", "flat"),), ("size_m", "gravity")
    )
    return Fit(
        hypotheses=(h,),
        values=((0.01, 1.0),),
        shifts={},
        cost=0.0,
        residual=residual,
        covariance=np.zeros((0, 0)),
    )


def noise():
    return np.random.default_rng(3).standard_normal(ROWS)


def test_a_detail_that_either_half_foretells_is_kept(objective, monkeypatch):
    monkeypatch.setattr(details, "jacobian", lambda *_: np.stack([SIZE, GROWTH], axis=1))
    residual = noise() + 2.0 * SIZE - 4.0 * GROWTH
    assert details.improves_cross_validation(objective, fit_of(residual), 0, ["gravity"])


def test_a_detail_that_fits_one_half_only_is_not(objective, monkeypatch):
    fluke = np.where(TIME < 0.5, 1.0, -1.0) * np.sin(70.0 * TIME)
    monkeypatch.setattr(details, "jacobian", lambda *_: np.stack([SIZE, fluke], axis=1))
    residual = noise() + 2.0 * np.abs(TIME < 0.5) * fluke - 1.0 * (TIME >= 0.5) * fluke * 0.5
    residual = np.where(TIME < 0.5, residual, noise() - 2.0 * fluke)
    assert not details.improves_cross_validation(objective, fit_of(residual), 0, ["gravity"])


def formed(monkeypatch, *, explained, costs, plain=1000.0, roll="unwind"):
    """Return the fit that is kept: its ``unwound_m``, None where it has none."""
    wider = hypothesis(BY_NAME["out_of_round_roll"], roll, traced=("unwound_m",), line=LINE)
    old = SimpleNamespace(hypotheses=(SimpleNamespace(names=("size_m",)),), cost=plain, start=None)
    monkeypatch.setattr(details, "_explained", lambda *_: explained)
    monkeypatch.setattr(details, "synchronised_shifts", lambda *_: {})
    monkeypatch.setattr(details, "cost_standard_deviation", lambda _: 100.0)
    monkeypatch.setattr(
        details,
        "_wider",
        lambda _p, _f, _a, names, start: SimpleNamespace(
            hypotheses=(wider,), values=((start[names[0]],),)
        ),
    )
    monkeypatch.setattr(
        details,
        "gauss_newton_fit",
        lambda _p, _h, at, *_, **__: SimpleNamespace(cost=costs[at[0][0]], start=at[0][0]),
    )
    return details._formed(SimpleNamespace(rows=40_000), old, 0).start


@pytest.mark.parametrize(
    ("costs", "kept"),
    [
        ((900.0, 800.0), 0.012),
        ((800.0, 900.0), 0.006),
        ((1099.0, 1098.0), 0.012),
        ((1200.0, 1101.0), None),
    ],
)
def test_a_strong_profile_is_as_old_as_fits_best_unless_that_is_clearly_worse(
    monkeypatch, costs, kept
):
    table = dict(zip((0.006, 0.012), costs, strict=True))
    assert formed(monkeypatch, explained=2e5, costs=table) == kept


def test_a_roll_that_winds_up_was_smaller_when_its_profile_was_formed(monkeypatch):
    costs = {-0.006: 900.0, -0.012: 800.0}
    assert formed(monkeypatch, explained=2e5, costs=costs, roll="rewind") == -0.012


def test_a_weak_profile_is_not_asked_where_it_was_formed(monkeypatch):
    assert formed(monkeypatch, explained=5e4, costs={}) is None
