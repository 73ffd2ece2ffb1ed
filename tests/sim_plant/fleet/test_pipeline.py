"""Rows once each, what was stopped goes on, and the command's exit codes."""

import hashlib
import json
import math
import os
import shutil
import signal
import threading
from dataclasses import replace
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from benchmarks.workers import by_hand
from sim_plant.base.shipped import shipped
from sim_plant.cli.main import main
from sim_plant.fleet import pipeline
from sim_plant.fleet.looks import fleet_in
from sim_plant.fleet.pipeline import TABLE, FleetPlan, refine_fleet
from sim_plant.fleet.refine_look import LookResult
from sim_plant.fleet.rows import kept_result, row_file
from sim_plant.refine.report.verdict import Verdict
from tests.sim_plant.fleet import jobs

pytestmark = pytest.mark.processes
NOTHING = Verdict(
    answer="nothing", effects=(), unknown=(), ambiguous=(), residual_rms={}, holdout="b.csv"
)


@pytest.fixture
def plan(tmp_path):
    """Return a plan of two lines: one with a row already, one whose line file is no line."""
    for name in ("film1", "film2"):
        folder = tmp_path / "runs" / name
        folder.mkdir(parents=True)
        for part in "ab":
            (folder / f"2026-11-20_{part}.csv").write_text("time_s\n0\n", encoding="utf-8")
        (tmp_path / "lines").mkdir(exist_ok=True)
        (tmp_path / "lines" / f"{name}.yaml").write_text("rollers: 3\n", encoding="utf-8")
    places = {name: tmp_path / name for name in ("lines", "runs", "out")}
    found = FleetPlan(**places, workers=1)
    first = fleet_in(found.lines, found.runs).looks[0]
    row = LookResult(line="film1", recorded="2026-11-20", verdict=NOTHING, error="", time_s=60.0)
    path = row_file(found.out, first.key)
    path.parent.mkdir(parents=True)
    path.write_text(row.to_json(), encoding="utf-8")
    return found


@pytest.mark.long  # real processes of refine; quick: the next
def test_what_has_a_row_is_not_done_again_and_a_failure_is_a_row(plan, capsys):
    said = []
    outcome = refine_fleet(plan, said.append)
    assert said[0] == "2 looks at 2 lines, 1 to refine"
    by_line = {f.line: f for f in outcome.findings}
    assert by_line["film1"].verdict == "nothing"
    assert by_line["film2"].verdict == "failed"
    assert "film2.yaml" in by_line["film2"].to_do
    again = []
    assert repr(refine_fleet(plan, again.append).findings) == repr(outcome.findings)  # with NaN
    assert again[0] == "2 looks at 2 lines, 1 to refine; 1 failed before"
    arguments = [str(plan.lines), "--runs", str(plan.runs), "--out", str(plan.out)]
    assert main(["fleet", *arguments]) == 0
    assert "film2 2026-11-20 failed" in capsys.readouterr().out


def test_so_many_looks_as_asked_are_done_and_the_rest_waits(plan, capsys, monkeypatch):
    monkeypatch.setattr(pipeline, "refine_look", jobs.failed)
    for row in (plan.out / "rows").iterdir():
        row.unlink()
    arguments = [str(plan.lines), "--runs", str(plan.runs), "--out", str(plan.out)]
    assert main(["fleet", *arguments, "--most", "1", "--workers", "1"]) == 0
    said = capsys.readouterr().out
    assert "2 looks at 2 lines, 1 to refine, 1 wait" in said
    assert "1 looks in " in said
    assert said.endswith("1 looks wait; the same command goes on\n")
    assert len(list((plan.out / "rows").iterdir())) == 1


def test_what_failed_is_done_again_and_a_page_links_what_is_there(plan, monkeypatch):
    """As after a full disk: the first night writes a failure, the second has room."""
    room = []

    def refined(_, todo, __):
        for order in todo:
            if room:
                order.out.mkdir(parents=True)
                (order.out / "report.html").write_text("found", encoding="utf-8")
            done = replace(jobs.failed(order), error="" if room else "No space left on device")
            yield order, replace(done, verdict=NOTHING) if room else done

    monkeypatch.setattr(pipeline, "_refined", refined)
    said = []
    outcome = refine_fleet(plan, said.append)
    assert [f.to_do for f in outcome.findings if f.verdict == "failed"] == [
        "No space left on device"
    ]
    page = (plan.out / pipeline.PAGE).read_text(encoding="utf-8")
    assert "href" not in page  # film1 was kept without its report, film2 has none
    room.append(True)
    outcome = refine_fleet(plan, said.append)
    assert said[-2] == "2 looks at 2 lines, 1 to refine; 1 failed before"
    assert {f.verdict for f in outcome.findings} == {"nothing"}
    page = (plan.out / pipeline.PAGE).read_text(encoding="utf-8")
    assert page.count("href") == 1
    assert "2 lines, 2 looks" in page
    refine_fleet(plan, said.append)
    assert said[-1] == "2 looks at 2 lines, 0 to refine"


def test_a_fleet_without_two_records_of_a_line_has_an_empty_table_and_says_so(plan, capsys):
    for folder in plan.runs.iterdir():
        (folder / "2026-11-20_b.csv").unlink()
    shutil.rmtree(plan.out)
    arguments = [str(plan.lines), "--runs", str(plan.runs), "--out", str(plan.out)]
    assert main(["fleet", *arguments]) == 0
    said = capsys.readouterr().out
    assert "no line has two records yet" in said
    assert f"0 rows in {plan.out / TABLE}" in said
    assert pq.read_table(plan.out / TABLE).num_rows == 0
    assert "0 lines, 0 looks" in (plan.out / pipeline.PAGE).read_text(encoding="utf-8")


@pytest.fixture
def nights(plan, monkeypatch):
    """Return a function of a night's work: what was given out, and the findings.

    A line called film2 fails; what a look finds depends on its records alone.
    """

    def night():
        given = []

        def refined(_, todo, __):
            for order in todo:
                given.append(order)
                verdict = None if order.look.line == "film2" else NOTHING
                yield order, replace(jobs.failed(order), verdict=verdict)

        monkeypatch.setattr(pipeline, "_refined", refined)
        findings = refine_fleet(plan, lambda _: None).findings
        return [f"{o.look.fitted.name} {o.look.held.name}" for o in given], findings

    return night


def days_of(findings, line):
    return [f.recorded for f in findings if f.line == line and f.verdict != "failed"]


def test_a_record_taken_away_or_put_before_changes_no_look_that_was_told(plan, nights):
    folder = plan.runs / "film1"
    for day in (21, 22):
        for part in "ab":
            (folder / f"2026-11-{day}_{part}.csv").write_text("time_s\n0\n", encoding="utf-8")
    given, findings = nights()
    told = ["2026-11-20", "2026-11-21", "2026-11-22"]
    assert len(given) == 3  # one was told before, by a row without names; film2 fails
    assert days_of(findings, "film1") == told
    assert pq.read_table(plan.out / TABLE).num_rows == 4
    (folder / "2026-11-20_a.csv").unlink()
    (folder / "2026-11-19_a.csv").write_text("time_s\n0\n", encoding="utf-8")
    given, findings = nights()
    assert given == ["2026-11-20_a.csv 2026-11-20_b.csv"]  # that of film2, which failed
    assert days_of(findings, "film1") == told
    (folder / "2026-11-23_a.csv").write_text("time_s\n0\n", encoding="utf-8")
    given, findings = nights()
    assert given[0] == "2026-11-19_a.csv 2026-11-23_a.csv"
    assert days_of(findings, "film1") == ["2026-11-19", *told]
    shutil.rmtree(folder)  # records are kept for a month, say
    assert days_of(nights()[1], "film1") == ["2026-11-19", *told]
    (plan.lines / "film1.yaml").unlink()
    assert {f.line for f in nights()[1]} == {"film2"}


def test_a_changed_line_file_replaces_what_can_be_looked_at_again(plan, nights):
    nights()
    (plan.lines / "film1.yaml").write_text("rollers: 4\n", encoding="utf-8")
    given, findings = nights()
    assert len(given) == 2
    assert days_of(findings, "film1") == ["2026-11-20"]
    (plan.runs / "film1" / "2026-11-20_a.csv").unlink()
    (plan.lines / "film1.yaml").write_text("rollers: 5\n", encoding="utf-8")
    _, findings = nights()
    assert days_of(findings, "film1") == ["2026-11-20"]
    four = hashlib.sha256(b"rollers: 4\n").hexdigest()[:16]  # the last that it was told under
    assert [f.declared for f in findings if f.line == "film1"] == [four]


def test_a_line_file_edited_at_night_is_not_what_was_looked_at(plan, monkeypatch):
    """The row names the file of before the work, in its key and in what it says."""
    file = plan.lines / "film2.yaml"
    before, digest = fleet_in(plan.lines, plan.runs).looks[1].key, hashlib.sha256()
    digest.update(file.read_bytes())

    def refined(_, todo, __):
        file.write_text("rollers: 7\n", encoding="utf-8")
        for order in todo:
            yield order, jobs.failed(order)

    monkeypatch.setattr(pipeline, "_refined", refined)
    refine_fleet(plan, lambda _: None)
    row = kept_result(row_file(plan.out, before), print)
    assert row.declared == digest.hexdigest()[:16]


def test_what_is_left_of_a_look_that_failed_is_paired_anew(plan, nights):
    nights()
    folder = plan.runs / "film2"
    (folder / "2026-11-20_a.csv").unlink()
    (folder / "2026-11-20_c.csv").write_text("time_s\n0\n", encoding="utf-8")
    given, findings = nights()
    assert given == ["2026-11-20_b.csv 2026-11-20_c.csv"]
    assert [f.verdict for f in findings if f.line == "film2"] == ["failed"]


def test_folders_named_from_here_reach_workers_that_are_elsewhere(plan, monkeypatch):
    given = []

    def refined(_, todo, __):
        given.extend(todo)
        return iter(())

    monkeypatch.setattr(pipeline, "_refined", refined)
    monkeypatch.chdir(plan.out.parent)
    here = {name: Path(name) for name in ("lines", "runs", "out")}
    refine_fleet(replace(plan, **here), print)
    (order,) = given
    paths = (order.look.file, order.look.fitted, order.look.held, order.out)
    monkeypatch.chdir("/")
    assert all(path.exists() for path in paths[:3])
    assert all(path.is_absolute() for path in paths)


@pytest.mark.long  # a process of refine; quick: what is a look, in test_looks
def test_what_cannot_be_read_is_a_failed_row_with_its_name_and_the_night_goes_on(plan):
    broken = plan.runs / "film2" / "2026-11-20_a.csv"
    broken.unlink()
    broken.symlink_to(plan.runs / "unmounted.csv")
    shutil.copy(shipped("lines/euclid.yaml"), plan.lines / "film2.yaml")
    (plan.lines / "film3.yaml").write_text("rollers: 3\n", encoding="utf-8")
    (plan.runs / "film3").symlink_to(plan.runs / "unmounted")
    said = []
    outcome = refine_fleet(plan, said.append)
    by_line = {f.line: f for f in outcome.findings}
    assert by_line["film1"].verdict == "nothing"
    assert by_line["film2"].verdict == by_line["film3"].verdict == "failed"
    assert "2026-11-20_a.csv" in by_line["film2"].to_do
    assert "film3: cannot be read" in by_line["film3"].to_do
    page = (plan.out / pipeline.PAGE).read_text(encoding="utf-8")
    assert "1 nothing, 2 failed" in page or "2 failed, 1 nothing" in page


@pytest.mark.long  # quick: a killed process of a job, in test_cluster
def test_a_worker_killed_in_the_middle_leaves_the_same_table(plan, tmp_path, monkeypatch):
    monkeypatch.setattr(pipeline, "refine_look", jobs.one_waits)
    note, wanted = plan.lines / "who", plan.lines / "wanted"
    for row in (plan.out / "rows").iterdir():
        row.unlink()
    wanted.touch()
    refine_fleet(plan, print)
    in_peace = (plan.out / TABLE).read_bytes()
    note.unlink()
    wanted.unlink()

    def kill_then_give():
        while not (note.exists() and note.read_text(encoding="utf-8")):
            threading.Event().wait(0.02)
        os.kill(int(note.read_text(encoding="utf-8").split()[0]), signal.SIGKILL)
        wanted.touch()

    with by_hand(tmp_path / "dask") as (address, workers):
        killer = threading.Thread(target=kill_then_give)
        killer.start()
        again = replace(plan, out=tmp_path / "again", scheduler=address)
        outcome = refine_fleet(again, print)
        killer.join()
        assert [worker.poll() for worker in workers].count(-signal.SIGKILL) == 1
    assert (outcome.refined, outcome.lost) == (2, [])
    assert len(note.read_text(encoding="utf-8").split()) == 2
    assert len(list((again.out / "rows").iterdir())) == 2
    assert (again.out / TABLE).read_bytes() == in_peace


@pytest.mark.parametrize(
    ("more", "says"),
    [
        (["--workers", "0"], "--workers 0: give more than 0"),
        (["--limit-s", "-1"], "--limit-s -1.0: give more than 0"),
        (["--example", "-2"], "--example -2: give a number of lines"),
        (["--most", "0"], "--most 0: give more than 0"),
    ],
)
def test_a_number_that_makes_no_sense_is_refused(more, says, tmp_path, capsys):
    folder = str(tmp_path)
    assert main(["fleet", folder, "--runs", folder, "--out", folder, *more]) == 2
    assert says in capsys.readouterr().err


def test_a_row_says_again_what_it_was_written_from():
    row = LookResult(
        line="film1",
        recorded="2026-11-20",
        verdict=NOTHING,
        error="",
        time_s=60.0,
        cpu_s=20.0,
        fitted="a",
        held="b",
        declared="0f",
    )
    assert LookResult.from_json(row.to_json()) == row
    of_before = {"line": "a", "recorded": "2026-11-20", "verdict": None, "error": "", "time_s": 1}
    old = LookResult.from_json(json.dumps(of_before))
    assert (old.fitted, old.held, old.declared) == ("", "", "")
    assert math.isnan(old.cpu_s)
    assert "cpu_s" not in json.loads(old.to_json())


NO_DAY = '{"line": "a", "recorded": "2000-12-34", "verdict": null, "error": "", "time_s": 1}'


@pytest.mark.parametrize(
    "text", ["", "{", "[1]", '{"line": 1}', '{"verdict": {}}', "null", "[" * 9999, NO_DAY]
)
def test_a_row_that_is_none_counts_as_not_done(text, tmp_path):
    said = []
    (tmp_path / "row.json").write_text(text, encoding="utf-8")
    assert kept_result(tmp_path / "row.json", said.append) is None
    assert len(said) == 1
    assert "it counts as not done" in said[0]
