import signal
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.refine.noise.innovations import declared_noise
from sim_plant.refine.pipeline import check_runs
from tests.orphans import outlived

KEEPER = """
import os, time
from sim_plant.refine.model.simulation_pool import SimulationPool
if __name__ == "__main__":
    with SimulationPool([], workers=2) as pool:
        jobs = [pool._pool.submit(os.getpid) for _ in range(8)]
        print(*sorted({job.result() for job in jobs}), flush=True)
        time.sleep(600)
"""


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM])
def test_workers_end_with_a_parent_that_was_killed(tmp_path, how):
    (tmp_path / "keeper.py").write_text(KEEPER)
    assert not outlived(tmp_path / "keeper.py", how)


def test_a_declared_line_that_does_not_run_is_refused_with_its_record():
    good, bad = np.zeros((2, 5)), np.full((2, 5), np.nan)
    records = [SimpleNamespace(path=Path("a.csv")), SimpleNamespace(path=Path("b.csv"))]
    pool = SimpleNamespace(run=lambda cases: [[good, good], [good, bad]])
    with pytest.raises(PlantError, match=r"b\.csv: the declared line does not run"):
        check_runs(pool, records)
    check_runs(SimpleNamespace(run=lambda cases: [[good, good]] * 2), records)


def test_a_channel_without_any_noise_is_refused_by_name():
    sensors = [SimpleNamespace(channel="x_N", lsb_m=None, lsb_rad=None)]
    line = SimpleNamespace(sensors=sensors, sample_time_s=0.01)
    twin = SimpleNamespace(declaration=line, channels=("x_N",))
    with pytest.raises(PlantError, match=r"sensors\.x_N: the line file declares no noise"):
        declared_noise(twin, np.zeros((3, 1, 400)))
