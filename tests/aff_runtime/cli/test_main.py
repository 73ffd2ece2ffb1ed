"""Exit codes and texts of the command line."""

from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.cli.main import main
from aff_runtime.cli.probe_map import table
from aff_runtime.config.loader import load_site
from aff_runtime.fieldbus.modbus.probe_map import MapProbe, ProbedWord
from tests.aff_runtime.fieldbus.rtu_slave import Slave
from tests.security.learned_files import CheckInProcess

ROOT = Path(__file__).parents[3]
SITE = ROOT / "config" / "euclid_blocks.yaml"


def test_a_good_file_passes_the_check(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(SITE)]) == 0
    assert "ok" in capsys.readouterr().out.splitlines()[-1]


def test_check_brief_shows_findings_and_result_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(SITE), "--brief"]) == 0
    *findings, result = capsys.readouterr().out.splitlines()
    assert all(line.startswith("warning  ") for line in findings)
    assert result.startswith(f"{SITE}: ok, ")


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
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("aff_runtime.app.supervisor.validation.Validation", CheckInProcess)
    assert main(["run", str(tmp_path / "none.yaml"), "--runtime-dir", str(tmp_path)]) == 2
    assert "none.yaml" in capsys.readouterr().err


@pytest.mark.wire
def test_probe_map_without_a_plc_is_a_matter_of_communication(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    site = tmp_path / "site.yaml"
    site.write_text(SITE.read_text().replace("port: 5020", "port: 1"))
    assert main(["probe-map", str(site)]) == 3
    assert "gateway: 127.0.0.1:1: Connection refused" in capsys.readouterr().err


def test_probe_map_shows_each_channel_as_the_site_file_reads_it() -> None:
    site = load_site(SITE)
    words = tuple(
        ProbedWord(address=place, u16=value, i16=value, changes=0, decodings=())
        for place, value in enumerate([1, 107, 1, 23564, 8896, 1019, 9905, *[0] * 9, 0xFFFE, 3])
    )
    seen = MapProbe(samples=2, failures=0, heartbeat_moves=True, words=words)
    text = "\n".join(table(site, seen))
    for said in ("unwind_tension_N = 89.1", "line_speed_m_s = 1.019", "unwind_radius_m = 0.1981"):
        assert said in text
    assert "applied.unwind = -2e-05" in text  # 0xFFFE = -2 counts of 0.00001 m/s
    assert "applied.swrap_follower = 3e-05" in text


def serial_site(folder: Path, device: str) -> Path:
    text = SITE.read_text().replace("cycle_ms: 5", "cycle_ms: 20")
    begin, end = text.index("  modbus_tcp:"), text.index("  # 0: the numbers below")
    wire = f"  modbus_rtu: {{ device: {device}, parity: none, deadline_ms: 15 }}\n"
    site = folder / "site.yaml"
    site.write_text((text[:begin] + wire + text[end:]).replace("_after_ms: 15", "_after_ms: 40"))
    return site


@pytest.mark.wire
def test_probe_map_reads_a_serial_line_and_writes_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    slave = Slave()
    words = [1, 107, 1, 23564, 8896, 1019, 9905, *[0] * 11]

    def scan(frame: bytes) -> bytes:
        words[0] += 1
        slave.registers.publish(list(words))
        return frame

    slave.registers.publish(list(words))
    slave.spoil = scan
    try:
        assert main(["probe-map", str(serial_site(tmp_path, slave.path))]) == 0
    finally:
        slave.close()
    said = capsys.readouterr().out
    assert "plc_heartbeat moves" in said
    assert "unwind_tension_N = 89.1" in said  # 1 x 65536 + 23564 counts of 0.001 N
    assert slave.registers.writes == 0


@pytest.mark.wire
def test_probe_map_names_a_serial_line_that_is_not_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["probe-map", str(serial_site(tmp_path, "/dev/ttyNONE"))]) == 3
    said = capsys.readouterr().err
    assert "gateway: the serial line /dev/ttyNONE does not open: " in said


def test_the_version_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert capsys.readouterr().out.startswith("aff-runtime ")


def test_the_version_of_a_release_is_one_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("aff_runtime.cli.main.release_text", lambda: f"1.2 (commit {'9f' * 20})")
    with pytest.raises(SystemExit):
        main(["--version"])
    (line,) = capsys.readouterr().out.splitlines()
    assert line.endswith((", law by compiled", ", law by numpy"))
