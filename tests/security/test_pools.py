"""Worker processes that are killed or hang: no job is lost, and none is done wrong."""

import os
import signal
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
import yaml

from aff_runtime.base.errors import AffError
from benchmarks.campaign.line import declaration
from sim_plant.cli.main import main
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.declaration import Declaration
from sim_plant.line.open import make_line
from sim_plant.refine.model.simulation_pool import Bench
from sim_plant.refine.model.twin import Case
from tests.orphans import begun, children
from tests.processes import kill, until

pytestmark = pytest.mark.timeout(120)
CASES = [Case(seed=number) for number in range(20)]
MB = 1 << 20


@dataclass(frozen=True)
class Twin:
    """A line that answers with the number of its case; ``hit`` says how often one goes wrong."""

    folder: Path
    how: str
    number: int = 7
    hits: int = 1
    channels: tuple[str, ...] = ()
    speed_m_s: np.ndarray = field(default_factory=lambda: np.zeros(1))

    def simulate(self, case):
        if case.seed == self.number and len(list(self.folder.iterdir())) < self.hits:
            (self.folder / str(os.getpid())).touch()
            if self.how == "killed":
                os.kill(os.getpid(), signal.SIGKILL)
            if self.how == "hangs":
                time.sleep(600.0)
            if self.how == "killed while it answers":
                return np.zeros(64 * MB)
        time.sleep(0.01)
        return np.array([float(case.seed)])


def answers(bench):
    return [float(run[0][0]) for run in bench.run(CASES)]


def test_twenty_jobs_and_a_killed_worker_give_twenty_answers_in_order(tmp_path):
    said = []
    with Bench([Twin(tmp_path, "killed")], 2, said.append) as bench:
        assert answers(bench) == list(range(20))
    assert said == [
        "simulation of record 1 with noise 7: its worker process was ended by signal 9 (Killed); "
        "it is done again"
    ]


def test_a_job_may_lose_two_workers(tmp_path):
    with Bench([Twin(tmp_path, "killed", hits=2)], 2) as bench:
        assert answers(bench) == list(range(20))
    assert len(list(tmp_path.iterdir())) == 2


def test_a_job_that_loses_a_third_worker_is_named(tmp_path):
    with (
        Bench([Twin(tmp_path, "killed", hits=99)], 2) as bench,
        pytest.raises(AffError, match=r"simulation of record 1 with noise 7: 3 worker processes"),
    ):
        bench.run(CASES)
    assert len(list(tmp_path.iterdir())) == 3


def test_a_worker_that_hangs_is_ended_in_time_and_its_job_done_again(tmp_path):
    said = []
    with Bench([Twin(tmp_path, "hangs")], 2, said.append, limit_s=2.0) as bench:
        assert answers(bench) == list(range(20))
    assert said == [
        "simulation of record 1 with noise 7: its worker process gave no answer within 2 s; it is "
        "done again"
    ]
    (hung,) = (int(path.name) for path in tmp_path.iterdir())
    until("the hanging worker is gone", lambda: not Path(f"/proc/{hung}").exists(), 2.0)


KEEPER = """
import sys
from pathlib import Path
import numpy as np
from sim_plant.refine.model.simulation_pool import Bench
from sim_plant.refine.model.twin import Case
from {module} import Twin
if __name__ == "__main__":
    with Bench([Twin(Path(sys.argv[1]), "killed while it answers")], 2) as bench:
        print(*(run[0].size for run in bench.run([Case(seed=n) for n in range(20)])))
"""


def writes_megabytes(pid):
    """Return whether a process is inside a write of more than a megabyte."""
    try:
        call = Path(f"/proc/{pid}/syscall").read_text().split()
    except OSError:
        return False
    return call[0] == "1" and int(call[3], 16) > MB


@pytest.mark.skipif(not Path("/proc/self/syscall").exists(), reason="this kernel hides its calls")
def test_a_worker_killed_while_it_hands_over_its_answer_does_not_stop_the_others(tmp_path):
    (tmp_path / "marks").mkdir()
    script = tmp_path / "keeper.py"
    script.write_text(KEEPER.format(module="tests.security.test_pools"))
    parent = begun([str(script), str(tmp_path / "marks")])
    found = []

    def in_the_middle():
        found[:] = [pid for pid in children(parent.pid) if writes_megabytes(pid)]
        return found

    until("a worker hands over", in_the_middle, 60.0)
    kill(found[0])
    try:
        said, _ = parent.communicate(timeout=60.0)
    finally:
        parent.kill()
        parent.wait()
    assert said.split() == ["1"] * 20


ROWS = 1200


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    """Return a folder with a line and 12 s of it."""
    folder = tmp_path_factory.mktemp("record")
    line = Declaration.model_validate(declaration())
    speed = np.interp(np.arange(ROWS), [0, 540, 660, ROWS], [0.9, 0.9, 1.3, 1.3])
    run = make_line(line, seed=4, speed_m_s=0.9, tension_N=89.0)
    run.settle(20.0)
    out = run.simulate(speed, np.full(ROWS, 89.0))
    table = {"time_s": 0.01 * np.arange(ROWS), "line_speed_ref_m_s": speed}
    table |= {"tension_ref_N": np.full(ROWS, 89.0)} | {
        s.channel: out[s.channel] for s in line.sensors
    }
    rows = [",".join(map(repr, map(float, row))) for row in zip(*table.values(), strict=True)]
    (folder / "r.csv").write_text("\n".join([",".join(table), *rows]) + "\n")
    (folder / "line.yaml").write_text(yaml.safe_dump(declaration(), sort_keys=False))
    return folder


def refine(folder, out, workers):
    """Return a command line: one effect in the library is enough work for two workers."""
    without = [w for name in BY_NAME if name != "bearing_drag" for w in ("--without", name)]
    line, csv = str(folder / "line.yaml"), str(folder / "r.csv")
    return ["refine", line, csv, "--out", str(out), "--workers", str(workers), *without]


def simulating(parent):
    """Return the processes of ``parent`` that simulate."""
    return [
        pid
        for pid in children(parent.pid)
        if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes()
    ]


def test_a_refine_whose_workers_are_killed_has_the_verdict_of_one_left_alone(record, tmp_path):
    parent = begun(["-m", "sim_plant.cli.main", *refine(record, tmp_path / "killed", 2)])
    said = []
    try:
        for line in parent.stdout:
            said.append(line)
            if line.startswith("simulating the declared line"):
                until("it has workers", lambda: len(simulating(parent)) == 2)
                kill(simulating(parent)[0])
        assert parent.wait() == 0, said
    finally:
        parent.kill()
        parent.communicate()
    assert any("its worker process was ended by signal 9" in line for line in said)
    assert main(refine(record, tmp_path / "alone", 1)) == 0
    one, other = (tmp_path / name / "verdict.json" for name in ("killed", "alone"))
    assert one.read_bytes() == other.read_bytes()
