"""``aff-runtime watch`` and ``export`` as they are typed."""

import json
import shutil
import sys

import duckdb
import numpy as np
import pandas as pd
import pyarrow.parquet
import pytest

from aff_runtime.app.report.metrics.readings import readings
from aff_runtime.app.report.run_export import unit_of_column
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.app.report.watch_notes import FILE, notes_of, read_notes
from aff_runtime.app.wiring.law_slot import LawSlot
from aff_runtime.app.wiring.site_to_law import site_params
from aff_runtime.base.runs.files import yaml_values
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import run_window
from aff_runtime.base.yaml_section import Section
from aff_runtime.cli.main import main
from aff_runtime.cli.status import watch_lines
from aff_runtime.config.loader import load_site
from aff_runtime.core.controller import Controller
from tests.doubles.virtual_weeks import Weeks, write_weeks
from tests.each_case import each_case
from tests.parameter_records import CONFIG

DAYS = 14


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    weeks = Weeks(r6_m=lambda km, _: 4e-5 + 2e-8 * km, scatter_m=2e-7)
    folder = tmp_path_factory.mktemp("runs")
    list(write_weeks(weeks, folder, range(DAYS)))
    return folder


@pytest.fixture(scope="module")
def store(runs, tmp_path_factory):
    store = tmp_path_factory.mktemp("made") / "store"
    assert main(["watch", "add", str(store), str(runs)]) == 0
    return store


def test_a_folder_of_runs_is_taken_and_what_grows_is_said(runs, tmp_path, capsys):
    store = tmp_path / "store"
    assert main(["watch", "add", str(store), str(runs), "--limit", "r6=60 um"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert sum("2 hours new, 1 of them without a steady stretch" in one for one in said) == DAYS
    assert said[-1].startswith("r6 1x stroke grows: ")
    assert "reaches 60 um in about " in said[-1]
    assert main(["watch", "add", str(store), str(runs)]) == 0
    assert "0 hours new, 2 known already" in capsys.readouterr().out


def test_what_is_no_run_is_named_and_the_others_are_taken(runs, store, tmp_path, capsys):
    assert (
        main(["watch", "add", str(tmp_path / "s"), str(tmp_path), str(min(runs.iterdir()))]) == 0
    )
    said = capsys.readouterr()
    assert "left out: " in said.err
    assert "not a run folder" in said.err
    assert "2 hours new" in said.out
    assert main(["watch", "add", str(tmp_path / "s"), str(tmp_path / "nowhere")]) == 1


def test_every_trend_is_listed_and_told_to_programs(store, capsys):
    assert main(["watch", "trend", str(store)]) == 0
    said = capsys.readouterr().out
    assert "  healthy 1x stroke (unwind_tension_N): 14 readings in 13 days at 1 m/s; 20" in said
    assert main(["watch", "trend", str(store), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    r6 = next(f for f in found["findings"] if (f["roll"], f["quantity"]) == ("r6", "stroke_m"))
    assert r6["stands_out"]
    assert found["without_a_line"] == []
    assert r6["per_km"]["low"] <= 2e-8 <= r6["per_km"]["high"]


def test_a_roller_has_a_limit_of_each_unit(store, capsys):
    words = ["watch", "trend", str(store), "--json", "--limit", "r6=0.2 mm", "--limit", "r6=2 N"]
    assert main(words) == 0
    found = json.loads(capsys.readouterr().out)["findings"]
    assert {f["limit"] for f in found if (f["roll"], f["quantity"]) == ("r6", "stroke_m")} == {
        2e-4
    }


@pytest.mark.parametrize(
    ("limits", "said"),
    [
        (["r6=0.2 mm", "r6=300 um"], "two limits of r6 are in m; give one"),
        (["r66=0.2 mm"], "r66: the store knows no such roller; it knows healthy, r6"),
    ],
)
def test_a_limit_that_would_be_lost_is_refused(limits, said, store, capsys):
    assert (
        main(["watch", "trend", str(store), *(w for one in limits for w in ("--limit", one))]) == 2
    )
    assert said in capsys.readouterr().err


def test_an_exchange_begins_a_new_life(store, tmp_path, capsys):
    own = shutil.copytree(store, tmp_path / "store")
    words = ["watch", "exchange", str(own), "r6", "--on", "2026-01-15", "--why", "serial 4711"]
    assert main(words) == 0
    assert "r6: a new life from 2026-01-15 00:00 UTC" in capsys.readouterr().out
    assert main(["watch", "trend", str(own)]) == 0
    assert "r6 1x stroke, life 2 (unwind_tension_N): 4 readings" in capsys.readouterr().out
    assert main(["watch", "exchange", str(own), "R6", "--on", "2026-01-15"]) == 2
    assert "knows no such roller; it knows healthy, r6" in capsys.readouterr().err


def test_what_was_found_is_shown_by_status_and_counted_by_metrics_until_it_is_answered(
    runs, store, tmp_path, capsys
):
    own = shutil.copytree(store, tmp_path / "store")
    assert next(watch_lines(own, "Weeks")).startswith("watch    r6 1x stroke grows: ")
    assert list(watch_lines(own, "another line")) == []
    assert list(watch_lines(tmp_path / "nowhere", "Weeks")) == []
    assert main(["watch", "add", str(own), str(runs), "--limit", "r6=60 um"]) == 0
    said = capsys.readouterr().out.splitlines()[-1]
    assert "reaches 60 um in about " in said
    shown, when = watch_lines(own, "Weeks")
    assert shown == f"watch    {said}"
    assert f"every trend: aff-runtime watch trend {own}" in when
    assert counted(own) == 1.0
    assert main(["watch", "exchange", str(own), "r6", "--on", "2026-01-15", "--why", "new"]) == 0
    assert list(watch_lines(own, "Weeks")) == []
    assert counted(own) == 0.0
    notes = read_notes(own)
    assert notes is not None
    assert notes.by_roller() == {("r6", "m"): pytest.approx(6e-5)}  # asked about next time too


def counted(store):
    """Return what the metrics say of a store."""
    answer = StatusAnswer(line="Weeks", state="OFF")
    found = {s.metric: s.value for s in readings(answer, 0, notes_of(store, answer.line))}
    assert found["aff_watch_timestamp_seconds"] == read_notes(store).looked_s
    return found["aff_watch_notes"]


@pytest.mark.parametrize(
    "text", ["", "3", "[", '{"line": "Weeks"}', '{"line": 1, "looked_utc": 2}']
)
def test_notes_that_cannot_be_read_are_none(text, tmp_path):
    (tmp_path / FILE).write_text(text)
    assert list(watch_lines(tmp_path, "Weeks")) == []


@pytest.mark.parametrize("words", [["trend"], ["exchange", "r6", "--on", "2026-01-15"]])
def test_where_no_store_is_how_to_begin_one_is_said_and_none_is_made(words, tmp_path, capsys):
    nowhere = tmp_path / "nowhere"
    assert main(["watch", words[0], str(nowhere), *words[1:]]) == 2
    assert "holds no store; `aff-runtime watch add STORE RUN_DIR`" in capsys.readouterr().err
    assert not nowhere.exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["exchange", "STORE", "r6", "--on", "31.1.2026"], "expected a date such as"),
        (["trend", "STORE", "--limit", "r6"], "expected ROLLER=SIZE such as"),
        (["trend", "STORE", "--limit", "r6=60"], "expected ROLLER=SIZE such as"),
        (["trend", "STORE", "--limit", "r6=60 s"], "is a time, expected a length"),
    ],
)
def test_what_cannot_be_read_says_what_was_expected(words, said, store, capsys):
    with pytest.raises(SystemExit):
        main(["watch", *[str(store) if w == "STORE" else w for w in words]])
    assert said in capsys.readouterr().err


def test_without_pyarrow_the_extra_is_named(runs, tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    run = str(min(runs.iterdir()))
    for words in (["watch", "add", str(tmp_path / "s")], ["export", "--out", str(tmp_path / "x")]):
        assert main([*words, run]) == 2
        assert 'pip install "aff-runtime[records]"' in capsys.readouterr().err


def test_duckdb_and_pandas_read_an_exported_run_with_its_units(runs, tmp_path, capsys):
    run, path = min(runs.iterdir()), tmp_path / "run.parquet"
    assert main(["export", f"{run}@0..30", "--out", str(path)]) == 0
    assert "1500 rows" in capsys.readouterr().out
    columns = read_table(run_window(f"{run}@0..30")).columns
    frame = pd.read_parquet(path)
    assert list(frame) == list(columns)
    np.testing.assert_array_equal(frame["unwind_tension_N"], columns["unwind_tension_N"])
    mean = duckdb.sql(f"select avg(unwind_tension_N), max(time_s) from '{path}'").fetchone()
    assert mean[0] == pytest.approx(columns["unwind_tension_N"].mean())
    schema = pyarrow.parquet.read_schema(path)
    assert schema.metadata[b"line"] == b"Weeks"
    units = {f.name: (f.metadata or {}).get(b"unit", b"").decode() for f in schema}
    wanted = {"time_s": "s", "unwind_tension_N": "N", "line_speed_m_s": "m/s", "tick_us": "us"}
    wanted |= {"correction_unwind_m_s": "m/s", "unwind.r6_1x.amplitude_m_s": "m/s", "state": ""}
    assert {name: units[name] for name in wanted} == wanted


@each_case(
    ("name", "unit"),
    [
        ("unwind_angle_rad", "rad"),
        ("applied_ratio_unwind_m_s", "1"),
        ("unwind.unwind_1x.shape_mm", "mm"),
        ("unwind.unwind_1x.phase_deg", "deg"),
        ("unwind.unwind_1x.gain_of_P", "1"),
        ("age_s", "s"),
        ("roll_id", ""),
    ],
)
def test_a_columns_unit_is_what_its_name_ends_with(name, unit):
    assert unit_of_column(name) == unit


@pytest.mark.parametrize("name", ["euclid", "euclid_blocks"])
def test_every_number_of_a_law_has_a_unit_and_a_word_none(name):
    path = CONFIG / f"{name}.yaml"
    site = Section(yaml_values(path.read_text()))
    law = LawSlot(Controller(site_params(load_site(path)), {}))
    units = {column: unit_of_column(column, site) for column in law.law_telemetry_names()}
    words = {"source", "quality", "state", "stage"}
    assert {one.rpartition(".")[2] for one, unit in units.items() if not unit} == words
    ripples = {one for one in units if one.endswith((".ripple", ".ripple_before"))}
    assert ripples
    assert {units[one] for one in ripples} == {"N"}


def test_ripple_has_the_unit_of_the_signal_of_its_own_actuator():
    signals = {"unwind": "web_tension_N", "infeed": "line_speed_m_s"}
    site = Section({"actuators": {n: {"error": {"signal": s}} for n, s in signals.items()}})
    assert unit_of_column("unwind.r6_1x.ripple", site) == "N"
    assert unit_of_column("infeed.r6_1x.ripple_before", site) == "m/s"
    assert unit_of_column("other.r6_1x.ripple", site) == ""
    assert unit_of_column("unwind.r6_1x.ripple") == ""


def test_what_a_run_lost_is_said_once_with_what_is_taken_of_it(runs, tmp_path, capsys):
    run = tmp_path / "run"
    shutil.copytree(min(runs.iterdir()), run)
    (run / "summary.json").unlink()
    site = run / "site.yaml"
    site.write_text(site.read_text().replace("unwind_tension_N:", "web_tension_N:"))
    assert main(["watch", "add", str(tmp_path / "s"), str(run)]) == 0
    said = capsys.readouterr().out
    assert f"{run}: no summary.json: the recorder did not end by itself" in said
    assert f"{run}: its site.yaml maps web_tension_N, the run has no such column" in said
    assert main(["watch", "add", str(tmp_path / "s"), str(run)]) == 0
    assert "summary.json" not in capsys.readouterr().out


def test_a_part_of_a_run_is_refused_with_what_to_give(runs, tmp_path, capsys):
    run = min(runs.iterdir())
    assert main(["watch", "add", str(tmp_path / "s"), f"{run}@5..30"]) == 2
    assert f"watch looks for the steady stretches of each hour itself: give {run}" in (
        capsys.readouterr().err
    )
