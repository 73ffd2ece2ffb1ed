from types import SimpleNamespace

import numpy as np

from sim_plant.refine.fit.gauss_newton import ASTRAY, gauss_newton_fit
from sim_plant.refine.fit.projection import Projector
from sim_plant.refine.model.nuisances import Nuisance

SD = 0.01
SLOPE = np.full(50, 400.0)


class StraightLine:
    """A record that a declared number explains in proportion; keeps what was simulated."""

    def __init__(self, true_shift):
        self.nuisances = [Nuisance(name="web.modulus_Pa", tolerance=2.0 * SD)]
        self.sd = np.array([SD])
        self.rows = SLOPE.size
        self.projector = Projector(np.append(SLOPE, 1.0 / SD)[:, None])
        self.true_shift, self.tried = true_shift, []
        self.pool = SimpleNamespace(one=self.simulate, run=lambda cases: [None for _ in cases])

    def simulate(self, case):
        self.tried.append(dict(case.shifts).get("web.modulus_Pa", 0.0))
        return [SLOPE * self.tried[-1]]

    def residual(self, run, shifts, _coarse):
        return np.append(SLOPE * self.true_shift - run[0], -shifts.get("web.modulus_Pa", 0.0) / SD)


def test_a_step_within_reason_is_taken_whole():
    objective = StraightLine(20 * SD)
    fit = gauss_newton_fit(objective, (), (), {})
    estimate = 20 * SD * (SLOPE @ SLOPE) / (SLOPE @ SLOPE + 1.0 / SD**2)
    np.testing.assert_allclose(fit.shifts["web.modulus_Pa"], estimate, rtol=1e-9)
    np.testing.assert_allclose(objective.tried[1], estimate, rtol=1e-9)


def test_no_line_is_simulated_that_a_step_would_put_far_beyond_its_tolerance():
    objective = StraightLine(300 * SD)
    gauss_newton_fit(objective, (), (), {}, rounds=1)
    assert len(objective.tried) == 2
    assert 0.0 < objective.tried[1] <= ASTRAY * SD


def test_a_step_that_leads_astray_at_every_length_leaves_the_fit_where_it_was():
    objective = StraightLine(5500 * SD)
    assert gauss_newton_fit(objective, (), (), {}).shifts == {}
    assert objective.tried == [0.0]
