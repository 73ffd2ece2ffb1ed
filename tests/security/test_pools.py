"""Worker processes that are killed or hang: no job is lost, and none is done wrong."""

import json
import os
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.errors import AffError
from benchmarks.campaign import __main__ as campaign
from benchmarks.campaign.line import declaration
from benchmarks.control import __main__ as control
from benchmarks.control import extras, store
from benchmarks.control.cases import constant_cases
from benchmarks.control.jobs import Job
from benchmarks.control.laws import OWN
from benchmarks.rows import read_row, write_row
from sim_plant.base import worker_pool
from sim_plant.cli.main import main
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.open import make_line
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Case
from tests import quick_yaml
from tests.orphans import begun, children
from tests.processes import kill, until
from tests.security.killers import (
    MB,
    StoppingContext,
    Twin,
    adopt,
    bench_rows,
    campaign_row,
    number_of,
)

pytestmark = [pytest.mark.processes, pytest.mark.timeout(120)]
CASES = [Case(seed=number) for number in range(20)]


def answers(bench):
    return [float(run[0][0]) for run in bench.run(CASES)]


def light_pool(twin, tell):
    """Return two workers that import next to nothing, and answer within 2 s or are ended."""
    return worker_pool.WorkerPool(
        number_of, 2, limit_s=2.0, tell=tell, begin=adopt, arguments=(twin,)
    )


def test_twenty_jobs_and_a_killed_worker_give_twenty_answers_in_order(tmp_path):
    said = []
    with light_pool(Twin(tmp_path, "killed"), said.append) as pool:
        assert pool.map(range(20)) == list(range(20))
    assert said == ["7: its worker process was ended by signal 9 (Killed); it is done again"]


@pytest.mark.long  # quick: above, by workers that import less
def test_twenty_simulations_and_a_killed_worker_give_twenty_answers_in_order(tmp_path):
    said = []
    with SimulationPool([Twin(tmp_path, "killed")], 2, said.append) as bench:
        assert answers(bench) == list(range(20))
    assert said == [
        "simulation of record 1 with noise 7: its worker process was ended by signal 9 (Killed); "
        "it is done again"
    ]


@pytest.mark.long
def test_a_job_may_lose_two_workers(tmp_path):
    with SimulationPool([Twin(tmp_path, "killed", hits=2)], 2) as bench:
        assert answers(bench) == list(range(20))
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.long  # quick: base/test_worker_pool.py
def test_a_job_that_loses_a_third_worker_is_named(tmp_path):
    with (
        SimulationPool([Twin(tmp_path, "killed", hits=99)], 2) as bench,
        pytest.raises(AffError, match=r"simulation of record 1 with noise 7: 3 worker processes"),
    ):
        bench.run(CASES)
    assert len(list(tmp_path.iterdir())) == 3


def test_a_worker_that_hangs_is_ended_in_time_and_its_job_done_again(tmp_path):
    said = []
    with light_pool(Twin(tmp_path, "hangs"), said.append) as pool:
        assert pool.map(range(20)) == list(range(20))
    assert said == ["7: its worker process gave no answer within 2 s; it is done again"]
    (hung,) = (int(path.name) for path in tmp_path.iterdir())
    until("the hanging worker is gone", lambda: not Path(f"/proc/{hung}").exists())


def test_a_worker_that_stops_in_the_middle_of_its_answer_is_ended_in_time(tmp_path):
    said = []
    with light_pool(Twin(tmp_path, "stopped while it answers"), said.append) as pool:
        assert pool.map(range(20)) == list(range(20))
    assert said == ["7: its worker process gave no answer within 2 s; it is done again"]


def test_a_worker_that_stops_before_it_takes_its_orders_is_ended_in_time(monkeypatch):
    """The orders of a refinement, its records among them, fit no pipe."""
    said = []

    def tell(text):
        said.append(text)
        monkeypatch.undo()  # the next one has its time, on a busy machine too

    monkeypatch.setattr(worker_pool, "START_S", 1.0)
    monkeypatch.setattr(worker_pool, "spawn_context", StoppingContext)
    with worker_pool.WorkerPool(
        abs, 1, limit_s=60.0, tell=tell, begin=len, arguments=(bytes(8 * MB),)
    ) as pool:
        assert pool.map([-1, 2]) == [1, 2]
    assert said == ["-1: its worker process was not ready for a job within 1 s; it is done again"]


KEEPER = """
import sys
from pathlib import Path
import numpy as np
from sim_plant.refine.model.simulation_pool import SimulationPool
from sim_plant.refine.model.twin import Case
from tests.security.killers import Twin
if __name__ == "__main__":
    with SimulationPool([Twin(Path(sys.argv[1]), "killed while it answers")], 2) as bench:
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
@pytest.mark.long
def test_a_worker_killed_while_it_hands_over_its_answer_does_not_stop_the_others(tmp_path):
    (tmp_path / "marks").mkdir()
    script = tmp_path / "keeper.py"
    script.write_text(KEEPER)
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
    exact = declaration() | {"tolerances": {"*": 0.0}}  # nothing to fit but the effect
    (folder / "line.yaml").write_text(quick_yaml.safe_dump(exact, sort_keys=False))
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


@pytest.mark.long
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


@pytest.fixture
def hits(tmp_path, monkeypatch):
    """Return how to say how often the jobs of the benches end their worker."""
    folder = tmp_path / "hits"
    folder.mkdir()

    def say(count):
        monkeypatch.setenv("HIT_FOLDER", str(folder))
        monkeypatch.setenv("HITS", str(count))
        monkeypatch.setattr(campaign, "run_case", campaign_row)
        monkeypatch.setattr(control, "do_together", bench_rows)
        monkeypatch.setattr(control.report, "line", str)

    return say


@pytest.mark.long  # quick: the same pool in the first test
def test_a_campaign_whose_worker_is_killed_has_a_row_of_every_case(tmp_path, hits, capsys):
    hits(1)
    assert campaign.run(100, range(4), 2, tmp_path, 1e9) == []
    assert [row["number"] for _, row in campaign.rows_of(tmp_path)] == [0, 1, 2, 3]
    assert (
        "case 1 of seed 100: its process ended by signal 9; it is done again"
        in capsys.readouterr().err
    )


@pytest.mark.long
def test_a_case_that_loses_three_workers_has_no_row_and_all_others_have(tmp_path, hits, capsys):
    hits(99)
    assert campaign.run(100, range(4), 2, tmp_path, 1e9) == [1]
    assert [row["number"] for _, row in campaign.rows_of(tmp_path)] == [0, 2, 3]
    assert "case 1 of seed 100: every try was lost" in capsys.readouterr().err
    hits(0)
    assert campaign.run(100, range(4), 2, tmp_path, 1e9) == []
    assert [row["number"] for _, row in campaign.rows_of(tmp_path)] == [0, 1, 2, 3]


TORN = {
    "empty": b"",
    "cut": b'{"number": 0, "group": "hea',
    "zeros": bytes(4096),
    "no text": b"\xff\xfe\x00",
    "null": b"null",
    "another table": b'{"number": 0}',
    "a list": b"[]",
}


@pytest.mark.parametrize("data", TORN.values(), ids=TORN)
def test_a_torn_row_is_not_done(tmp_path, hits, capsys, data):
    hits(0)
    (tmp_path / "rows").mkdir()
    torn = tmp_path / "rows" / "00000.json"
    torn.write_bytes(data)
    assert campaign.rows_of(tmp_path) == []
    said = capsys.readouterr().err
    assert said.startswith(f"{torn}: no whole row (")
    assert said.endswith("); it counts as not done, run it again\n")


@pytest.mark.long
def test_a_case_whose_row_is_torn_is_done_again(tmp_path, hits):
    hits(0)
    (tmp_path / "rows").mkdir()
    (tmp_path / "rows" / "00000.json").write_bytes(b"")
    assert campaign.run(100, range(2), 1, tmp_path, 1e9) == []
    assert [row["number"] for _, row in campaign.rows_of(tmp_path)] == [0, 1]


def test_the_report_of_a_campaign_leaves_a_torn_row_out(tmp_path, hits, monkeypatch, capsys):
    rows = tmp_path / "rows"
    rows.mkdir()
    (rows / "00000.json").write_bytes(b"")
    (rows / "00001.json").write_text(json.dumps(campaign_row((100, 2, None))))
    arguments = ["campaign", "--report-only", "--out", str(tmp_path)]
    monkeypatch.setattr(sys, "argv", arguments)
    assert campaign.main() == 0
    said = capsys.readouterr()
    assert "00000.json: no whole row (0 bytes, " in said.err
    assert (tmp_path / "refine-campaign.md").read_text() == said.out.removesuffix("\n")


def test_a_row_is_whole_or_what_it_was(tmp_path, monkeypatch):
    path = tmp_path / "rows" / "row.json"
    write_row(path, {"number": 1})
    seen = []

    def full(file):
        seen.append(path.read_text())
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        write_row(path, {"number": 2})
    assert seen == ['{\n "number": 1\n}\n']
    assert read_row(path, ("number",)) == {"number": 1}
    assert list(path.parent.iterdir()) == [path]


JOB = Job(section="constant", case=constant_cases()[0], law="FxLMS", seed=1)


@pytest.mark.parametrize("data", TORN.values(), ids=TORN)
def test_a_torn_row_of_the_control_bench_is_not_done(tmp_path, capsys, data):
    store.save(tmp_path, JOB, {"ripple": 0.5})
    assert store.load(tmp_path, JOB) == {"ripple": 0.5}
    store.place(tmp_path, JOB).write_bytes(data)
    assert store.load(tmp_path, JOB) is None
    assert ": no whole row (" in capsys.readouterr().err


def test_a_torn_list_of_the_control_bench_is_left_out(tmp_path, capsys):
    for name in ("runs", "timing", "memory", "wire"):
        (tmp_path / f"{name}.json").write_bytes(b"")
    assert extras.rows(tmp_path) == []
    extras.note_run(tmp_path, 3, 1.0, 1.0)
    assert capsys.readouterr().err.count("no whole row") == 4
    assert [row["rows"] for row in json.loads((tmp_path / "runs.json").read_text())] == [3]


@pytest.mark.long
def test_a_control_bench_whose_worker_is_killed_has_every_row(tmp_path, hits, capsys):
    jobs = [
        replace(JOB, law=law, case=constant_cases()[at]) for at, law in enumerate(("FxLMS", OWN))
    ]
    hits(1)
    assert control.run_jobs(jobs, tmp_path, 2) == (2, 2.0, 0)
    hits(99)
    assert control.run_jobs(jobs, tmp_path, 2) == (2, 1.0, 1)
    said = capsys.readouterr().err
    name = f"1 rows of constant, {JOB.case.name}, seed 1"
    assert f"{name}: its worker process was ended by signal 9" in said
    assert f"{name}: 3 worker processes in turn" in said
