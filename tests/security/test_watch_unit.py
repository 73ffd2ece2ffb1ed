"""What the nightly look at the records may do, and that a person switches it on."""

from __future__ import annotations

import configparser
from pathlib import Path

import pytest

from aff_runtime.cli.main import build_parser
from aff_runtime.config.site_paths import STATE_DIRECTORY
from tests.each_case import each_case
from tests.security.installed_units import (
    DEPLOY,
    analyze,
    install,
    needs_analyze,
    runnable,
    settings,
    stub_in,
    words_of,
)

UNIT = settings("aff-watch.service")
SERVICE = settings("aff-runtime.service")
COMMISSIONER = settings("aff-commission.service")
STORE = STATE_DIRECTORY / "watch"


@each_case(
    ("key", "words"),
    [
        ("User", SERVICE["User"][0]),
        ("NoNewPrivileges", "yes"),
        ("CapabilityBoundingSet", ""),
        ("ProtectSystem", "strict"),
        ("ReadWritePaths", str(STORE)),
        ("PrivateNetwork", "yes"),
        ("RestrictRealtime", "yes"),
        ("NoExecPaths", "/"),
        ("MemoryDenyWriteExecute", "yes"),
        ("RemoveIPC", "no"),
        ("Nice", "19"),
        ("IOSchedulingClass", "idle"),
    ],
)
def test_what_it_does_without_is_taken_from_it(key: str, words: str) -> None:
    assert UNIT[key] == [words]


def test_its_command_is_one_that_the_program_takes_and_meets_service_and_screen() -> None:
    program, *words = words_of(UNIT)
    assert program == words_of(SERVICE)[0]
    assert words.pop() == "$AFF_WATCH_OPTIONS"
    options = build_parser().parse_args(words)
    assert options.store == STORE
    assert options.runs == [STATE_DIRECTORY / "runs"]
    _, *others = words_of(COMMISSIONER)
    others.remove("$AFF_COMMISSION_OPTIONS")
    assert build_parser().parse_args(others).watch == options.store


def test_the_timer_starts_it_every_night_and_makes_up_for_one_that_was_missed() -> None:
    timer = configparser.ConfigParser(interpolation=None)
    timer.optionxform = str  # type: ignore[assignment,method-assign]
    timer.read(DEPLOY / "aff-watch.timer")
    assert timer["Timer"]["OnCalendar"] == "*-*-* 03:20:00"
    assert timer["Timer"]["Persistent"] == "true"
    assert timer["Install"]["WantedBy"] == "timers.target"
    assert "[Install]" not in (DEPLOY / "aff-watch.service").read_text()


@needs_analyze
@pytest.mark.parametrize("words", [["verify"], ["security", "--offline=true", "--threshold=15"]])
def test_systemd_accepts_the_unit_and_it_is_exposed_no_more_than_1_5_of_10(
    words: list[str], tmp_path: Path
) -> None:
    path = runnable(tmp_path, "aff-watch.service")
    done = analyze(*words, str(path))
    assert done.returncode == 0, done.stdout[-300:] + done.stderr
    assert words != ["verify"] or (done.stdout, done.stderr) == ("", "")


@needs_analyze
def test_systemd_accepts_the_timer_beside_its_unit(tmp_path: Path) -> None:
    runnable(tmp_path, "aff-watch.service")
    path = tmp_path / "aff-watch.timer"
    path.write_text((DEPLOY / "aff-watch.timer").read_text())
    done = analyze("verify", str(path))
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_records_brings_unit_timer_and_store_and_switches_nothing_on(tmp_path: Path) -> None:
    stub, root = stub_in(tmp_path), tmp_path / "root"
    units = root / "etc/systemd/system"
    assert install(root, python=stub).returncode == 0
    assert not list(units.glob("aff-watch*"))
    done = install(root, "--records", python=stub)
    assert done.returncode == 0
    for name in ("aff-watch.service", "aff-watch.timer"):
        assert (units / name).read_bytes() == (DEPLOY / name).read_bytes()
    assert (root / "var/lib/aff-runtime/watch").is_dir()
    assert not [line for line in done.stdout.splitlines() if line.startswith("+ systemctl")]
    assert "once the line runs: systemctl enable --now aff-watch.timer" in done.stdout


def test_it_stays_off_the_processor_of_the_control_process_where_there_are_two(
    tmp_path: Path,
) -> None:
    stub, root = stub_in(tmp_path), tmp_path / "root"
    assert install(root, "--records", "--hmi", python=stub).returncode == 0
    units = root / "etc/systemd/system"
    ours = units / "aff-watch.service.d/cpu.conf"
    screen = units / "aff-hmi.service.d/cpu.conf"
    assert ours.exists() == screen.exists()
    assert not ours.exists() or ours.read_text() == screen.read_text()


def test_an_update_without_the_option_brings_the_unit_that_is_there_up_to_date(
    tmp_path: Path,
) -> None:
    stub, root = stub_in(tmp_path), tmp_path / "root"
    assert install(root, "--records", python=stub).returncode == 0
    unit = root / "etc/systemd/system/aff-watch.service"
    unit.write_text("of a release before")
    assert install(root, python=stub).returncode == 0
    assert unit.read_bytes() == (DEPLOY / "aff-watch.service").read_bytes()
