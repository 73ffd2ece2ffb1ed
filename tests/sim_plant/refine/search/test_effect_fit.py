from types import SimpleNamespace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search import effect_fit as one_effect

NAMES = ("size_m", "angle_rad", "smoothing_rad")
FLAT = hypothesis(BY_NAME["out_of_round_roll"], "unwind", (("shape", "flat"),), NAMES)
DELAY = hypothesis(BY_NAME["loop_delay"], "unwind")
TRUE_RAD, VALLEY_RAD = 3.0, 0.1
OBJECTIVE = SimpleNamespace(pool=SimpleNamespace(twins=[SimpleNamespace(declaration=None)]))


def fit_at(angle_rad, delay_s=0.05):
    cost = 1e5 + 1e6 * min(1.0, abs(angle_rad - TRUE_RAD))
    return Fit(
        hypotheses=(FLAT, DELAY),
        values=((0.012, angle_rad, 0.0), (delay_s,)),
        shifts={},
        cost=cost,
        residual=np.zeros(0),
        covariance=np.zeros((0, 0)),
    )


@pytest.fixture
def narrow_valley(monkeypatch):
    """A fit that gets to the true angle from close by only, and a first guess at 2.95 rad."""

    def fitted(_problem, hypotheses, values, _shifts):
        angle_rad = values[0][1]
        assert hypotheses == (FLAT, DELAY)
        return fit_at(TRUE_RAD if abs(angle_rad - TRUE_RAD) < VALLEY_RAD else angle_rad)

    monkeypatch.setattr(one_effect, "hypothesis", lambda *_, **__: FLAT)
    monkeypatch.setattr(one_effect, "synchronised_shifts", lambda _, shifts, *__: shifts)
    monkeypatch.setattr(one_effect, "gauss_newton_fit", fitted)
    monkeypatch.setattr(one_effect, "_profiles", lambda *_: [(FLAT, (0.011, 2.95, 0.02))])


def test_a_profile_is_found_anew_once_the_delay_is_known(narrow_valley):
    found = one_effect.profile_reinitialised(OBJECTIVE, fit_at(2.6))
    assert found.values[0][1] == TRUE_RAD
    assert found.hypotheses == (FLAT, DELAY)


def test_a_profile_that_fits_better_as_it_is_stays(narrow_valley, monkeypatch):
    monkeypatch.setattr(one_effect, "_profiles", lambda *_: [(FLAT, (0.011, 0.4, 0.02))])
    there = fit_at(TRUE_RAD)
    assert one_effect.profile_reinitialised(OBJECTIVE, there) is there
