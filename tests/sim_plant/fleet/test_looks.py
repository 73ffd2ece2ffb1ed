"""Two records of a line are a look; another file is another look."""

import hashlib
import os

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.fleet.looks import Told, fleet_in


@pytest.fixture
def fleet(tmp_path):
    lines, runs = tmp_path / "lines", tmp_path / "runs"
    for name in ("film1", "film2"):
        (runs / name).mkdir(parents=True)
        lines.mkdir(exist_ok=True)
        (lines / f"{name}.yaml").write_text(f"# {name}\n", encoding="utf-8")
    return lines, runs


def put(runs, *names):
    for name in names:
        (runs / name).write_text("time_s\n", encoding="utf-8")


def test_records_pair_in_the_order_of_their_names_and_the_odd_one_waits(fleet):
    lines, runs = fleet
    put(runs, *(f"film1/2026-11-{day}.csv.gz" for day in (22, 20, 24, 21, 23)))
    put(runs, "film1/2026-11-20.yaml", "film1/notes.md")  # a sidecar and a note are no record
    looks = fleet_in(lines, runs).looks
    assert [(look.fitted.name[8:10], look.held.name[8:10]) for look in looks] == [
        ("20", "21"),
        ("22", "23"),
    ]
    assert [look.recorded for look in looks] == ["2026-11-20", "2026-11-22"]


def pairs_of(looks):
    return [f"{look.fitted.stem[-2:]}{look.held.stem[-2:]}" for look in looks]


TOLD = [Told("film1", "2026-11-20.csv", "2026-11-21.csv", False)]


@pytest.mark.parametrize(
    ("days", "told", "pairs"),
    [
        ((20, 21, 22, 23), [], ["2021", "2223"]),
        ((19, 20, 21, 22, 23), TOLD, ["1922", "2021"]),  # put before: the pair stays
        ((21, 22, 23), TOLD, ["2223"]),  # one deleted: the other one is used up
        ((22, 23), TOLD, ["2223"]),
        ((21, 22, 23), [TOLD[0]._replace(failed=True)], ["2122"]),  # free: nothing came of it
        ((20, 21, 22, 23), [TOLD[0]._replace(failed=True)], ["2021", "2223"]),
        ((20, 21, 22, 23), [TOLD[0]._replace(line="film2")], ["2021", "2223"]),
    ],
)
def test_what_was_told_of_stays_a_pair_and_only_the_rest_is_paired(fleet, days, told, pairs):
    lines, runs = fleet
    put(runs, *(f"film1/2026-11-{day}.csv" for day in days))
    assert pairs_of(fleet_in(lines, runs, told).looks) == pairs


def test_what_cannot_be_read_is_a_look_by_its_name_and_another_once_it_can(fleet):
    lines, runs = fleet
    gone = runs / "film1" / "2026-11-20.csv"
    gone.symlink_to(runs / "nowhere.csv")
    put(runs, "film1/2026-11-21.csv")
    (runs / "film1" / "2026-11-19").symlink_to(runs / "unmounted")  # was a run folder
    (runs / "film1" / "zz").mkdir()
    (runs / "film1" / "zz" / "signals.csv").symlink_to(runs / "nowhere.csv")
    first, second = fleet_in(lines, runs).looks
    assert [first.fitted.name, first.held.name] == ["2026-11-19", "2026-11-20.csv"]
    keys = [first.key, second.key]
    gone.unlink()
    put(runs, "film1/2026-11-20.csv")
    first, second = fleet_in(lines, runs).looks
    assert first.key != keys[0]
    assert second.key == keys[1]
    (lines / "film1.yaml").unlink()
    (lines / "film1.yaml").symlink_to(lines / "nowhere")
    assert second.key != keys[1]
    assert second.mark().declared == hashlib.sha256(b"").hexdigest()[:16]


def test_a_line_whose_folder_leads_nowhere_is_closed_and_the_others_have_their_looks(fleet):
    lines, runs = fleet
    put(runs, "film2/a.csv", "film2/b.csv")
    (runs / "film1").rmdir()
    (runs / "film1").symlink_to(runs / "unmounted")
    (runs / "latest").symlink_to(runs / "unmounted")  # of no line
    found = fleet_in(lines, runs)
    assert [look.line for look in found.looks] == ["film2"]
    (shut,) = found.closed
    assert shut.line == "film1"
    assert "film1: cannot be read (No such file or directory)" in shut.error


def test_runs_of_the_service_are_folders(fleet):
    lines, runs = fleet
    for name in ("20261120T101500", "20261121T101500"):
        (runs / "film2" / name).mkdir()
        put(runs, f"film2/{name}/signals-0001.csv.gz")
    (look,) = fleet_in(lines, runs).looks
    assert (look.line, look.recorded) == ("film2", "2026-11-20")


def test_a_record_without_a_day_in_its_name_has_that_of_its_writing(fleet):
    lines, runs = fleet
    put(runs, "film1/a.csv", "film1/b.csv")
    os.utime(runs / "film1" / "a.csv", (1_700_000_000, 1_700_000_000))  # 2023-11-14 UTC
    assert fleet_in(lines, runs).looks[0].recorded == "2023-11-14"


def test_the_key_of_a_look_changes_with_its_line_file_and_its_records(fleet):
    lines, runs = fleet
    put(runs, "film1/a.csv", "film1/b.csv")
    (look,) = fleet_in(lines, runs).looks
    keys = [look.key]
    (lines / "film1.yaml").write_text("# with a roller more\n", encoding="utf-8")
    keys.append(look.key)
    (runs / "film1" / "b.csv").write_text("time_s,more\n", encoding="utf-8")
    keys.append(look.key)
    assert len(set(keys)) == 3


def test_records_without_a_line_file_are_refused_with_what_to_do(fleet):
    lines, runs = fleet
    (runs / "paper").mkdir()
    with pytest.raises(PlantError, match=r"put paper\.yaml into .*lines"):
        fleet_in(lines, runs)


def test_a_folder_without_line_files_or_that_is_none_is_refused(fleet, tmp_path):
    _, runs = fleet
    with pytest.raises(PlantError, match="no line file"):
        fleet_in(runs, runs)
    with pytest.raises(PlantError, match="cannot be read"):
        fleet_in(tmp_path / "nowhere", runs)


@pytest.mark.parametrize(
    ("name", "day"),
    [
        ("run_1720001234567_a.csv", "2023-11-14"),  # of its writing: no part of a longer number
        ("2026-02-30.csv", "2023-11-14"),
        ("20001345.csv", "2023-11-14"),
        ("20001345_20261120.csv", "2026-11-20"),
        ("film1_20261120T101500.csv", "2026-11-20"),
        ("20261120101500.csv", "2026-11-20"),
        ("2024-02-29_b.csv", "2024-02-29"),
    ],
)
def test_eight_digits_that_are_no_day_are_none(fleet, name, day):
    lines, runs = fleet
    put(runs, f"film1/{name}", "film1/zz.csv")
    os.utime(runs / "film1" / name, (1_700_000_000, 1_700_000_000))  # 2023-11-14 UTC
    assert fleet_in(lines, runs).looks[0].recorded == day
