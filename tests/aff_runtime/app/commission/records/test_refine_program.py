"""The program as it is: its command is one that it takes, its words are those that are read."""

import json
import os
import subprocess
import sys
import time
from dataclasses import asdict

import pytest

pytest.importorskip("numba")

from aff_runtime.app.commission.records import refine_program
from aff_runtime.app.commission.records.refine_program import (
    EXTRA,
    command_line,
    command_of,
    program,
    run,
)
from aff_runtime.app.commission.records.refine_shelf import Shelf
from aff_runtime.app.commission.views.of_refining import AskedOf
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.refinement import SUMMARY
from sim_plant.cli.main import build_parser
from sim_plant.cli.refine import plan_of
from tests.aff_runtime.app.commission.test_job import is_there

ASKED = AskedOf(windows=("a",), holdout=("b",), without=(), by="carl", utc="u")


def test_the_command_is_one_that_the_program_takes_as_it_was_meant():
    words = command_of("l.yaml", ["a@0..9"], ["b"], ["roll_bounce"], site="s.yaml", out="o")
    plan = plan_of(build_parser(words[0]).parse_args(words))
    assert [str(path) for path in (plan.line, *plan.records, *plan.holdout)] == [
        "l.yaml",
        "a@0..9",
        "b",
    ]
    assert (plan.without, plan.workers) == (("roll_bounce",), 1)
    assert (str(plan.site), str(plan.out)) == ("s.yaml", "o")
    assert build_parser("refine").parse_args([*words, "--lacking"]).lacking
    assert command_line(("refine", "a b")) == "sim-plant refine 'a b'"


def test_what_an_input_lacks_is_the_programs_own_sentence(tmp_path):
    said = []
    words = command_of(str(tmp_path / "none.yaml"), ["a"], [], [], site="s", out=str(tmp_path))
    why = run(words, tmp_path / "log.txt", said.append)
    assert "none.yaml" in why
    assert said == []


@pytest.mark.parametrize("name", EXTRA)
def test_without_a_part_of_the_extra_there_is_no_program(monkeypatch, tmp_path, name):
    assert program() is not None
    there = refine_program.importlib.util.find_spec
    monkeypatch.setattr(
        refine_program.importlib.util, "find_spec", lambda n: None if n == name else there(n)
    )
    assert program() is None
    with pytest.raises(RefusedError, match="not installed"):
        run(("refine",), tmp_path / "log.txt", print)


def test_a_verdict_of_another_release_is_none(tmp_path):
    shelf = Shelf(tmp_path / "site.yaml", tmp_path)
    folder = shelf.begin(ASKED, "site: 1\n")
    (folder / "out").mkdir()
    (folder / "out" / SUMMARY).write_text(json.dumps({"version": 9, "kind": "traced"}))
    assert shelf.row(1).kind == ""
    assert json.loads((folder / "asked.json").read_text()) == json.loads(json.dumps(asdict(ASKED)))


def test_nothing_begins_where_the_disk_has_little_room(tmp_path, monkeypatch):
    class Full:
        free = 499_000_000

    monkeypatch.setattr("shutil.disk_usage", lambda folder: Full())
    shelf = Shelf(tmp_path / "site.yaml", tmp_path)
    with pytest.raises(RefusedError, match="left to the records"):
        shelf.begin(ASKED, "")
    assert shelf.numbers() == []


JOB = """
import sys
from pathlib import Path
from aff_runtime.app.commission import background_process
from aff_runtime.app.commission.records import refine_program
background_process.leave_to_control()
refine_program.program = lambda: Path(sys.argv[1])
refine_program.run((), Path(sys.argv[2]), lambda line: print(line, flush=True))
"""
BUSY = """#!{python}
import json, os, resource, time
said = {{"pid": os.getpid(), "nice": os.nice(0), "on": sorted(os.sched_getaffinity(0))}}
said["file"] = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
said["processor"] = resource.getrlimit(resource.RLIMIT_CPU)[0]
print(json.dumps(said), flush=True)
time.sleep(600)
"""


def test_the_program_is_bounded_gives_way_and_ends_with_the_job_that_is_killed(tmp_path):
    busy = tmp_path / "busy"
    busy.write_text(BUSY.format(python=sys.executable))
    busy.chmod(0o700)
    command = [sys.executable, "-c", JOB, str(busy), str(tmp_path / "log.txt")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as job:
        said = json.loads(job.stdout.readline())
        assert is_there(said["pid"])
        job.kill()
    allowed = sorted(os.sched_getaffinity(0))
    assert said["on"] == (allowed[:-1] if len(allowed) > 1 else allowed)
    assert said["nice"] == 19
    assert said["file"] == refine_program.FILE_BYTES
    assert said["processor"] == refine_program.PROCESSOR_S
    give_up = time.monotonic() + 20.0
    while is_there(said["pid"]) and time.monotonic() < give_up:
        time.sleep(0.02)
    if is_there(said["pid"]):
        os.kill(said["pid"], 9)
        raise AssertionError("the program went on")
