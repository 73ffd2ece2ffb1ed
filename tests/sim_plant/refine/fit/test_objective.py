from types import SimpleNamespace

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.refine.fit.objective import Objective
from sim_plant.refine.model.nuisances import Nuisance
from sim_plant.refine.model.twin import Case

HEALTHY = np.zeros((1, 5))


def objective(run):
    return SimpleNamespace(
        anchor=Case(),
        coarse=[HEALTHY],
        pool=SimpleNamespace(run=run),
        nuisances=[
            Nuisance(name="web.EA_N", tolerance=500.0),
            Nuisance(name="web.width_m", tolerance=0.01),
        ],
    )


def test_a_tolerance_at_whose_end_the_line_does_not_run_is_refused_by_name():
    def run(cases):
        broken = [dict(case.shifts).get("web.EA_N", 0.0) > 1.0 for case in cases]
        return [[np.full((1, 5), np.nan)] if b else [HEALTHY] for b in broken]

    with pytest.raises(PlantError, match=r"tolerances: web\.EA_N may be 500 off.*a smaller one"):
        Objective._take_changes(objective(run))


def test_what_a_unit_changes_is_the_slope_over_the_tolerance():
    def run(cases):
        return [[HEALTHY + 3.0 * sum(dict(case.shifts).values())] for case in cases]

    changes = Objective._take_changes(objective(run))
    np.testing.assert_allclose(changes, 3.0)
