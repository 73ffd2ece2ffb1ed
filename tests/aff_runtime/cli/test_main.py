"""Exit codes and texts of the command line."""

from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.cli.main import main
from aff_runtime.cli.probe_map import table
from aff_runtime.config.loader import load_site
from aff_runtime.fieldbus.probe_map import MapProbe, ProbedWord

ROOT = Path(__file__).parents[3]
SITE = ROOT / "config" / "euclid_blocks.yaml"


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


def test_probe_map_shows_each_channel_as_the_site_file_reads_it() -> None:
    site = load_site(SITE)
    words = tuple(
        ProbedWord(address=place, u16=value, i16=value, changes=0, decodings=())
        for place, value in enumerate([1, 107, 1, 23564, 8896, 1019, 9905, *[0] * 8])
    )
    seen = MapProbe(samples=2, failures=0, heartbeat_moves=True, words=words)
    text = "\n".join(table(site, seen))
    for said in ("unwind_tension_N = 89.1", "line_speed_m_s = 1.019", "unwind_radius_m = 0.1981"):
        assert said in text


def test_probe_map_says_that_it_does_not_look_at_a_serial_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = SITE.read_text().replace("cycle_ms: 5", "cycle_ms: 20")
    wire = "  modbus_rtu: { device: /dev/ttyS0, deadline_ms: 15 }\n"
    text = text.replace("  modbus_tcp:\n", wire)
    for line in ("host: 127.0.0.1", "port: 5020", "device_id: 1"):
        text = text.replace(f"    {line}\n", "")
    site = tmp_path / "site.yaml"
    site.write_text(text)
    assert main(["probe-map", str(site)]) == 2
    assert "serial line" in capsys.readouterr().err


def test_the_version_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert capsys.readouterr().out.startswith("aff-runtime ")
