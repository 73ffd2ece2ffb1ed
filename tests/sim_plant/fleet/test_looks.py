"""Two records of a line are a look; another file is another look."""

import os

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.fleet.looks import looks_in


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
    looks = looks_in(lines, runs)
    assert [(look.fitted.name[8:10], look.held.name[8:10]) for look in looks] == [
        ("20", "21"),
        ("22", "23"),
    ]
    assert [look.recorded for look in looks] == ["2026-11-20", "2026-11-22"]


def test_runs_of_the_service_are_folders(fleet):
    lines, runs = fleet
    for name in ("20261120T101500", "20261121T101500"):
        (runs / "film2" / name).mkdir()
        put(runs, f"film2/{name}/signals-0001.csv.gz")
    (look,) = looks_in(lines, runs)
    assert (look.line, look.recorded) == ("film2", "2026-11-20")


def test_a_record_without_a_day_in_its_name_has_that_of_its_writing(fleet):
    lines, runs = fleet
    put(runs, "film1/a.csv", "film1/b.csv")
    os.utime(runs / "film1" / "a.csv", (1_700_000_000, 1_700_000_000))  # 2023-11-14 UTC
    assert looks_in(lines, runs)[0].recorded == "2023-11-14"


def test_the_key_of_a_look_changes_with_its_line_file_and_its_records(fleet):
    lines, runs = fleet
    put(runs, "film1/a.csv", "film1/b.csv")
    (look,) = looks_in(lines, runs)
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
        looks_in(lines, runs)


def test_a_folder_without_line_files_or_that_is_none_is_refused(fleet, tmp_path):
    _, runs = fleet
    with pytest.raises(PlantError, match="no line file"):
        looks_in(runs, runs)
    with pytest.raises(PlantError, match="cannot be read"):
        looks_in(tmp_path / "nowhere", runs)


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
    assert looks_in(lines, runs)[0].recorded == day
