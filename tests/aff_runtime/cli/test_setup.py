"""`aff-runtime setup` against the simulated PLC: played by a file, left, killed, unplugged."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_runtime.cli.main import main
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Site
from benchmarks.wizard.answers import MACHINE_ANSWERS
from tests.aff_runtime.cli.virtual_line import VirtualLine
from tests.processes import until
from tests.sim_plant.servers.served import Served, served

ROOT = Path(__file__).parents[3]
ANSWERS = {
    "host": "127.0.0.1",
    "name": "Euclid",
    "second": "swrap_follower",
    "unwind_tension_N.display": "20.2 lbf",
    "unwind_tension_N.pick": "1",
    "tension_ref_N.display": "90.00 N",
    "tension_ref_N.pick": "1",
    "line_speed_m_s.display": "6.00 m/s",
    "line_speed_m_s.pick": "w5",
    "unwind_radius_m.display": "150.0 mm",
    "unwind_radius_m.pick": "1",
    "swrap_follower_speed_m_s.display": "360.0 m/min",
    "swrap_follower_speed_m_s.pick": "1",
    "swrap_follower_tension_N.display": "95.0 N",
    "swrap_follower_tension_N.pick": "1",
    "unwind_angle_rad.pick": "w11",
    "swrap_follower_angle_rad.pick": "w13",
    "speed_max": "1500 FPM",
    **MACHINE_ANSWERS,
    "probe": "0.02",
    "status.word": "1",
    "roll_id": "8",
    "echo": "15",
    "applied.unwind": "16",
    "applied.swrap_follower": "17",
}


@pytest.fixture
def plc(monkeypatch: pytest.MonkeyPatch) -> Iterator[Served]:
    """A PLC that runs; setup looks for less long than it does at a machine."""
    monkeypatch.setattr("aff_runtime.app.setup.modbus.display_steps.VALUE_S", 0.8)
    monkeypatch.setattr("aff_runtime.app.setup.modbus.steps.LOOK_S", 1.5)
    with served(VirtualLine()) as running:
        yield running


def script(folder: Path, port: int, **changes: str | None) -> Path:
    answers = {
        **ANSWERS,
        "port": str(port),
        **{k.replace("__", "."): v for k, v in changes.items()},
    }
    path = folder / "answers.yaml"
    path.write_text(
        "".join(f"{k}: {json.dumps(v)}\n" for k, v in answers.items() if v is not None)
    )
    return path


def played(folder: Path, answers: Path) -> int:
    return main(
        ["setup", str(folder / "site.yaml"), "--answers", str(answers), "--state-dir", str(folder)]
    )


def words_of(site: Site) -> dict[str, object]:
    """Return every word with its place, type and scale; channels by their register."""
    read, write = site.gateway.read, site.gateway.write
    given = site.gateway.model_dump(include={"address_base", "word_order"})
    singles = {
        name: getattr(read, name).register_number
        for name in ("plc_heartbeat", "status", "roll_id", "aff_echo")
    }
    singles |= {
        name: getattr(write, name).register_number
        for name in ("aff_heartbeat", "state", "echo", "alarm", "limit", "config_revision")
    }
    channels = {
        channel.register_number: (channel.type, channel.scale, channel.wraps)
        for channel in read.channels.values()
    }
    return {
        **given,
        **singles,
        "channels": channels,
        "applied": site.gateway.applied,
        "corrections": write.corrections,
    }


@pytest.mark.wire
def test_a_script_finds_the_words_of_the_shipped_site_file(plc: Served, tmp_path: Path) -> None:
    unasked = {f"{roll}_angle_rad__pick": None for roll in ("unwind", "swrap_follower")}
    assert played(tmp_path, script(tmp_path, plc.port, **unasked)) == 0
    found, shipped = load_site(tmp_path / "site.yaml"), load_site(ROOT / "config/euclid.yaml")
    assert words_of(found) == words_of(shipped)
    assert found.permissives == shipped.permissives
    counts = plc.command("status")["counts"]
    assert (counts["writes"], counts["foreign_writes"]) == (0, 0)


@pytest.mark.wire
def test_two_encoders_that_can_be_one_rolls_are_asked_for(
    plc: Served, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert (
        played(tmp_path, script(tmp_path, plc.port, second="none", unwind_angle_rad__pick=None))
        == 2
    )
    seen = capsys.readouterr()
    assert "no answer to unwind_angle_rad.pick" in seen.err
    assert "word 11 i32 high_first: 4096 counts/turn; measured " in seen.out
    assert "word 13 i32 high_first: 4000 counts/turn; measured " in seen.out


@pytest.mark.wire
def test_a_plc_that_is_unplugged_is_named_and_the_next_run_goes_on(
    plc: Served, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    answers, kept = script(tmp_path, plc.port), tmp_path / "site.setup.json"

    def unplug() -> None:
        until("a word is kept", lambda: kept.exists() and "line_speed_m_s" in kept.read_text())
        plc.fault("refuse")

    puller = threading.Thread(target=unplug)
    puller.start()
    assert played(tmp_path, answers) == 3
    puller.join()
    said = capsys.readouterr().err
    assert f"127.0.0.1:{plc.port}: " in said
    assert "What was found is kept." in said
    assert not (tmp_path / "site.yaml").exists()
    assert plc.command("clear")["ok"]
    assert played(tmp_path, answers) == 0
    said = capsys.readouterr().out
    assert "unwind_tension_N: word 2 i32 high_first, scale 0.001 (kept)" in said
    assert f"next: understand the warnings, then `aff-runtime run {tmp_path}" in said


# quick: of one that ends by itself, above; what is kept is whole: security/test_written_files.py
@pytest.mark.long
@pytest.mark.wire
def test_a_killed_run_goes_on_where_it_was(plc: Served, tmp_path: Path) -> None:
    answers, kept = script(tmp_path, plc.port), tmp_path / "site.setup.json"
    command = [
        sys.executable,
        "-m",
        "aff_runtime.cli.main",
        "setup",
        str(tmp_path / "site.yaml"),
        "--answers",
        str(answers),
    ]
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, env={**os.environ})
    try:
        until("a word is kept", lambda: kept.exists() and "tension_ref_N" in kept.read_text())
    finally:
        child.kill()
        child.wait()
    before = json.loads(kept.read_text())["words"]
    assert played(tmp_path, answers) == 0
    after = json.loads(kept.read_text())["words"]
    assert {name: after[name] for name in before} == before


@pytest.mark.wire
def test_own_status_bits_and_a_manual_that_counts_from_40001(plc: Served, tmp_path: Path) -> None:
    answers = script(
        tmp_path,
        plc.port,
        number="40001",
        second="none",
        status__order="no",
        bits__LINE_RUN="1.0",
        bits__AFF_ENABLE_REQUEST="none",
        bits__WEB_INTACT="1.3",
        bits__TENSION_VALID="none",
        bits__ESTOP_OK="15.1 inverted",
        echo="none",
    )
    assert played(tmp_path, answers) == 0
    site = load_site(tmp_path / "site.yaml")
    assert site.gateway.address_base == 1
    assert site.gateway.read.plc_heartbeat.register_number == 40001
    bits = site.gateway.read.status.bits
    assert bits is not None
    estop = bits.ESTOP_OK
    assert estop is not None
    assert (estop.register_number, estop.bit, estop.inverted) == (40016, 1, True)
    assert site.permissives.need == ("LINE_RUN", "WEB_INTACT", "ESTOP_OK")
    assert not site.permissives.enable_from_plc
    assert list(site.actuators) == ["unwind"]


KEPT = {
    "answers": {
        "wire": "modbus_tcp",
        "host": "127.0.0.1",
        "device_id": "1",
        "first": "0",
        "count": "100",
        "heartbeat": "0",
        "scan_ms": "10",
        "number": "0",
        "name": "Line 1",
        "second": "none",
        "tension_ref_N.display": "skip",
        "unwind_angle_rad.display": "skip",
        "probe": "0.0008",
        "speed_max": "8",
        "tension_max": "400",
        "radius_min": "4 in",
        "radius_max": "12 in",
        "limit": "0.05",
        "function": "fc23",
        "law": "blocks",
        "status.word": "1",
        "status.order": "no",
        "roll_id": "8",
        "echo": "none",
        "write": "100",
        "correction_scale": "0.00001",
    },
    "words": {
        "unwind_tension_N": {"address": 2, "type": "i32", "order": "high_first", "scale": "0.001"},
        "line_speed_m_s": {"address": 5, "type": "i16", "order": "", "scale": "0.001"},
        "unwind_radius_m": {"address": 6, "type": "u16", "order": "", "scale": "0.02 mm"},
    },
}


@pytest.mark.wire
@pytest.mark.parametrize(
    ("word", "said"),
    [
        ({"address": 40}, "word 40 i16 is not among the words that the PLC gives"),
        ({"scale": "1 lbf"}, "is a force, expected a speed"),
    ],
)
def test_a_kept_word_that_cannot_be_is_named(
    plc: Served,
    word: dict[str, object],
    said: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    kept = json.loads(json.dumps(KEPT))
    kept["words"]["line_speed_m_s"] |= word
    (tmp_path / "site.setup.json").write_text(json.dumps(kept))
    assert played(tmp_path, script(tmp_path, plc.port)) == 2
    assert "site.setup.json: words.line_speed_m_s: " in (error := capsys.readouterr().err)
    assert said in error


@pytest.mark.wire
@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"unwind_tension_N__display": "20.2 mm"}, "is a length, expected a force"),
        ({"unwind_tension_N__display": "20.2"}, "has no unit"),
        ({"unwind_tension_N__pick": "9"}, "write 1 to 5 or again"),
        ({"tension_ref_N__display": None}, "no answer to tension_ref_N.display"),
        ({"number": "7"}, "word 0 can be 0, 1, 40001, 400001 in a manual, not 7."),
    ],
)
@pytest.mark.sweep(every=3)
def test_an_answer_that_cannot_be_is_refused_at_its_line(
    plc: Served,
    changes: dict[str, str | None],
    said: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    answers = script(tmp_path, plc.port, **changes)
    assert played(tmp_path, answers) == 2
    error = capsys.readouterr().err
    assert said in error
    assert f"{answers}:" in error


@pytest.mark.wire
def test_one_word_is_not_two_things_and_the_window_is_the_window(
    plc: Served, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert played(tmp_path, script(tmp_path, plc.port, roll_id="4")) == 2
    assert "word 4 is tension_ref_N already." in capsys.readouterr().err
    assert played(tmp_path, script(tmp_path, plc.port, roll_id="200")) == 2
    assert "word 200 is outside the window 0 to 99." in capsys.readouterr().err
    own = {"status__order": "no", "bits__LINE_RUN": "1.0", "bits__AFF_ENABLE_REQUEST": "1.0"}
    assert played(tmp_path, script(tmp_path, plc.port, **own)) == 2
    assert "bit 0 of word 1 is LINE_RUN already." in capsys.readouterr().err
    assert played(tmp_path, script(tmp_path, plc.port, **own | {"bits__LINE_RUN": "4.1"})) == 2
    assert "word 4 is tension_ref_N already." in capsys.readouterr().err
    assert played(tmp_path, script(tmp_path, plc.port, status__order="yes", write="10")) == 2
    assert "would be written, and 10 is swrap_follower_tension_N." in capsys.readouterr().err
    (tmp_path / "site.yaml").write_text("mine\n")
    assert played(tmp_path, script(tmp_path, plc.port)) == 0
    assert (tmp_path / "site.yaml").read_text() == "mine\n"
    assert played(tmp_path, script(tmp_path, plc.port, replace="yes")) == 0
    assert (tmp_path / "site.yaml").read_text() != "mine\n"


def test_nobody_at_a_terminal_is_told_of_the_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["setup", str(tmp_path / "site.yaml")]) == 2
    assert "--answers FILE.yaml" in capsys.readouterr().err


def test_again_refuses_a_name_of_which_nothing_is_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "site.setup.json").write_text(json.dumps(KEPT))
    answers = script(tmp_path, 1)
    said = ["setup", str(tmp_path / "site.yaml"), "--answers", str(answers), "--again", "radius"]
    assert main(said) == 2
    error = capsys.readouterr().err
    assert "--again radius: nothing of that name is kept in" in error
    assert "Did you mean radius_m" in error


@pytest.mark.parametrize(
    ("wire", "said"), [("can", "Did you mean can_dbc?"), ("modbus_rtu", "serial")]
)
def test_another_wire_is_told_what_to_do_instead(
    wire: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert played(tmp_path, script(tmp_path, 1, wire=wire)) == 2
    assert said in capsys.readouterr().err


def test_a_technician_mistypes_leaves_and_comes_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    typed = iter(["modbus_tpc", "", "10.0.0.1", "99999", "5020", "q", "", "q"])
    monkeypatch.setattr("builtins.input", lambda _prompt: next(typed))
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    site = str(tmp_path / "site.yaml")
    assert main(["setup", site]) == 0
    seen = capsys.readouterr()
    assert '"modbus_tpc" is not known. Did you mean modbus_tcp?' in seen.err
    assert '"99999": write a whole number, 1 to 65535.' in seen.err
    assert "The same command goes on from there." in seen.out
    assert main(["setup", site, "--again", "port"]) == 0
    seen = capsys.readouterr()
    assert "host: 10.0.0.1 (kept)" in seen.out
    assert "port: 5020 (kept)" not in seen.out


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "is no JSON"),
        ("[" * 60000, "is no JSON"),
        ('{"answers": {"port": "a\\u0000b"}}', "answers.port"),
        ('{"words": {"x_N": {"address": 70000}}}', "words.x_N.address"),
        ('{"more": 1}', "more"),
        (
            '{"words": {"x_N": {"address": 1, "type": "i16", "order": "", "scale": "1 } #"}}}',
            "words.x_N.scale",
        ),
    ],
)
def test_a_broken_or_hostile_draft_is_a_clear_error(
    text: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "site.setup.json").write_text(text)
    assert played(tmp_path, script(tmp_path, 1)) == 2
    error = capsys.readouterr().err
    assert said in error
    assert "site.setup.json" in error


def test_a_kept_answer_that_is_none_is_a_clear_error_where_the_file_does_not_answer(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "site.setup.json").write_text('{"answers": {"port": "no port"}}')
    answers = script(tmp_path, 1)
    rest = [line for line in answers.read_text().splitlines() if not line.startswith("port:")]
    answers.write_text("\n".join(rest))
    assert played(tmp_path, answers) == 2
    error = capsys.readouterr().err
    assert 'answers.port: "no port": write a whole number' in error
    assert "site.setup.json" in error
