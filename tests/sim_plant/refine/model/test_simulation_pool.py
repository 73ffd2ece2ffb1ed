import signal
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.refine.model.twin import Case
from sim_plant.refine.noise.innovations import declared_noise
from sim_plant.refine.pipeline import check_runs
from sim_plant.refine.records.recording import Recording
from tests.orphans import outlived
from tests.sim_plant.refine.small import formula_twin, pool_of

pytestmark = pytest.mark.processes

KEEPER = """
import os, time
import numpy as np
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Case
class Twin:
    channels, speed_m_s = (), np.zeros(1)
    def simulate(self, case):
        return os.getpid()
if __name__ == "__main__":
    with SimulationPool([Twin()], workers=2) as pool:
        print(*sorted({run[0] for run in pool.run([Case(seed=n) for n in range(8)])}), flush=True)
        time.sleep(600)
"""


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM])
@pytest.mark.sweep(every=2)
def test_workers_end_with_a_parent_that_was_killed(tmp_path, how):
    (tmp_path / "keeper.py").write_text(KEEPER)
    assert not outlived(tmp_path / "keeper.py", how)


def test_a_declared_line_that_does_not_run_is_refused_with_its_record():
    def quick_only(case):
        return np.full((1, 5), 0.0 if case.quick else np.nan)

    good = formula_twin(lambda _: np.zeros((1, 5)), ["unwind_tension_N"], 5)
    bad = formula_twin(quick_only, ["unwind_tension_N"], 5)
    records = [
        Recording(path=Path(name), sha256=name, sample_time_s=0.01, columns={})
        for name in ("a.csv", "b.csv")
    ]
    with pytest.raises(PlantError, match=r"b\.csv: the declared line does not run"):
        check_runs(pool_of(good, bad), records)
    check_runs(pool_of(good, good), records)


def test_a_channel_without_any_noise_is_refused_by_name():
    twin = formula_twin(lambda _: np.zeros((1, 400)), ["r3_tension_N"], 400)
    with pytest.raises(PlantError, match=r"sensors\.r3_tension_N: the line file declares no"):
        declared_noise(twin, np.zeros((3, 1, 400)))


def test_a_case_is_simulated_once_unless_its_result_was_not_to_be_kept_or_was_dropped():
    twin = formula_twin(lambda case: np.zeros((1, 8)), ("unwind_tension_N",), 8)
    one, other = Case(), Case(seed=1)
    pool = pool_of(twin)
    pool.run([other], keep=False)
    pool.run([one, one])
    pool.run([one, other], keep=False)
    assert twin.simulated == [other, one, other]
    pool.forget()
    pool.responses["kept"] = []
    assert np.array_equal(pool.one(one)[0], np.zeros((1, 8)))
    assert twin.simulated == [other, one, other, one]
    assert pool.simulations == 4
    assert "kept" in pool.responses
