"""Every unbroken piece of a window as a record: what each holds is what its window alone holds."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from aff_runtime.base.signals import Status
from sim_plant.base.shipped import shipped
from sim_plant.cli.main import main
from sim_plant.cli.refine import pieces_in
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.run_caveats import rolls_of
from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.run_windows import unbroken_windows
from tests.aff_runtime.app.card.measure.recorded import recorded, steady
from tests.aff_runtime.app.fake_plc import READY_STATUS

SPLICES_S = ((21.0, 22.0), (30.0, 31.0))
"""Pieces of 21 s, 8 s (no record), and 24 s."""
END_S = 55.0


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    columns = steady(END_S)
    time_s, rng = columns["time_s"], np.random.default_rng(1)
    columns["status"][:] = READY_STATUS
    columns["unwind_tension_N"] += rng.standard_normal(time_s.size)
    for from_s, to_s in SPLICES_S:
        inside = (time_s >= from_s) & (time_s < to_s)
        columns["status"][inside] = READY_STATUS | int(Status.SPLICE_ACTIVE)
        columns["roll_id"][time_s >= to_s] += 1.0
    return recorded(tmp_path_factory.mktemp("pieces"), columns, segment_s=60.0)


def spans(paths):
    found = [read_record(path).run for path in paths]
    return [(one.from_s, one.to_s) for one in found]


def test_every_piece_that_is_long_enough_is_a_window_in_its_order(run):
    found = spans(unbroken_windows(run))
    assert found == [pytest.approx((0.0, 21.0), abs=0.03), pytest.approx((31.0, 55.0), abs=0.03)]


def test_the_longest_piece_is_the_record_that_it_was(run):
    whole, pieces = read_record(run), [read_record(path) for path in unbroken_windows(run)]
    longest = max(pieces, key=lambda one: one.duration_s)
    same = {n: v for n, v in longest.columns.items() if not n.startswith("correction_")}
    assert longest.samples == pytest.approx(whole.samples, abs=3)  # what acted at its edge
    for name, values in same.items():
        assert values[-1000:] - values[-1] == pytest.approx(
            whole.columns[name][-1000:] - whole.columns[name][-1]
        )


def test_a_window_without_a_break_is_itself(run):
    window = f"{run}@0.5..21"
    found = [read_record(path).sha256 for path in unbroken_windows(window)]
    assert found == [read_record(window).sha256]


def test_a_window_without_a_record_is_left_to_be_refused(run):
    window = f"{run}@22..30"
    assert unbroken_windows(window) == [window]


def test_of_too_many_pieces_the_longest_are_taken(run, monkeypatch):
    records = replace(CRITERIA.records, most_pieces=1)
    monkeypatch.setattr(
        "sim_plant.refine.records.run_windows.CRITERIA", replace(CRITERIA, records=records)
    )
    assert spans(unbroken_windows(run)) == [pytest.approx((31.0, 55.0), abs=0.03)]


def test_the_command_says_which_records_it_takes(run, tmp_path, capsys):
    file = tmp_path / "other.csv"
    assert pieces_in([file, run]) == [file, *unbroken_windows(run)]
    assert "2 records" in capsys.readouterr().out


def test_records_of_several_rolls_are_named(run):
    records = [read_record(path) for path in unbroken_windows(run)]
    assert [one.run.roll_id for one in records] == [4.0, 6.0]
    assert len(rolls_of(records)) == 1
    assert "2 rolls of web" in rolls_of(records)[0]
    assert rolls_of(records[:1]) == []


def test_a_run_that_cannot_be_used_is_named_beside_what_the_others_lack(run, tmp_path, capsys):
    nowhere = Path(f"{run}@900..950")
    assert pieces_in([nowhere, run]) == [nowhere, *unbroken_windows(run)]
    words = [str(shipped("lines/euclid.yaml")), str(nowhere), str(run), "--pieces", "--lacking"]
    assert main(["refine", *words, "--out", str(tmp_path)]) == 2
    told = json.loads((tmp_path / "lacking.json").read_text(encoding="utf-8"))["records"]
    assert [one["name"] for one in told] == [one.name for one in (nowhere, *unbroken_windows(run))]
    assert told[0]["refused"]
    assert f"{nowhere.name}: cannot be used: " in capsys.readouterr().out


def test_before_the_work_the_ends_of_a_window_and_a_site_file_of_another_line_are_named(
    run, tmp_path, capsys
):
    words = [str(shipped("lines/euclid.yaml")), f"{run}@31..95", "--lacking"]
    words += ["--out", str(tmp_path), "--site"]
    assert main(["refine", *words, str(shipped("film.yaml"))]) == 0
    out = capsys.readouterr().out
    assert "nothing is recorded from 55.0 s to 95 s, where it ends" in out
    assert "--site film.yaml: this site file is of line Film, the runs are of Euclid" in out
    assert main(["refine", *words, str(shipped("lines/euclid.yaml"))]) == 2
    assert "expected the site file of the service" in capsys.readouterr().err


def test_a_segment_alone_is_refused_with_the_folder_to_give(run):
    with pytest.raises(PlantError, match=rf"is one segment of a run.* give .*{run}@FROM\.\.TO"):
        read_record(run / "signals-0001.csv.gz")
