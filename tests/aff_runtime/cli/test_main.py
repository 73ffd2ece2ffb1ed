"""Exit codes and texts of the command line."""

from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.cli.main import main

ROOT = Path(__file__).parents[3]
SITE = ROOT / "config" / "euclid.yaml"


def test_a_good_file_passes_the_check(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(SITE)]) == 0
    assert "ok" in capsys.readouterr().out.splitlines()[-1]


def test_a_bad_file_is_refused_with_its_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bad = tmp_path / "site.yaml"
    bad.write_text(SITE.read_text().replace("cycle_ms: 5", "cycle_ms: fast"))
    line = 1 + bad.read_text().splitlines().index("  cycle_ms: fast")
    assert main(["check", str(bad)]) == 2
    assert f"{bad}:{line}:" in capsys.readouterr().err


def test_a_speed_that_is_no_speed_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(SITE), "--speed", "-1"]) == 2
    assert "--speed" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["arm", "bypass", "stop", "status", "shadow", "top"])
def test_without_a_service_every_word_says_how_to_start_one(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([command, "--runtime-dir", str(tmp_path)]) == 3
    said = capsys.readouterr().err
    assert "aff-runtime run SITE.yaml" in said
    assert "Traceback" not in said


def test_run_with_a_bad_file_ends_with_2_and_starts_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bad = tmp_path / "site.yaml"
    bad.write_text("version: 2\n")
    runtime = tmp_path / "rt"
    assert main(["run", str(bad), "--runtime-dir", str(runtime)]) == 2
    assert f"{bad}:1:" in capsys.readouterr().err
    assert not runtime.exists()


def test_a_missing_file_is_a_matter_of_configuration(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", str(tmp_path / "none.yaml"), "--runtime-dir", str(tmp_path)]) == 2
    assert "none.yaml" in capsys.readouterr().err


@pytest.mark.wire
def test_probe_map_without_a_plc_is_a_matter_of_communication(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    site = tmp_path / "site.yaml"
    site.write_text(SITE.read_text().replace("port: 5020", "port: 1"))
    assert main(["probe-map", str(site)]) == 3
    assert "check host, port" in capsys.readouterr().err
