"""`aff-runtime setup` from a DBC or EDS file: played by a file, and by a technician who types."""

from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.app.setup.asking.draft import read_draft
from aff_runtime.app.setup.bus.questions import scales_from
from aff_runtime.app.setup.words.display import shown_value
from aff_runtime.cli.main import main
from aff_runtime.config.loader import load_site
from tests.aff_runtime.app.setup.bus_answers import CONFIG, begun

SHIPPED = {"dbc": "euclid_can.yaml", "canopen": "euclid_canopen.yaml"}


@pytest.mark.parametrize("protocol", SHIPPED)
def test_the_names_of_the_files_lead_to_the_signals_of_the_shipped_site(
    protocol: str, tmp_path: Path
) -> None:
    assert main(begun(tmp_path, protocol)) == 0
    found, shipped = load_site(tmp_path / "site.yaml"), load_site(CONFIG / SHIPPED[protocol])
    assert found.gateway == shipped.gateway
    assert found.permissives == shipped.permissives
    assert found.rolls == shipped.rolls
    assert found.line.cycle_ms == shipped.line.cycle_ms
    assert list(found.actuators) == list(shipped.actuators)
    assert found.actuators["swrap_follower"].error.signal == "pullroll_tension_N"
    assert "@" not in (tmp_path / "site.yaml").read_text(encoding="utf-8")


def test_a_signal_is_shown_with_what_the_file_says_of_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(begun(tmp_path, "dbc")) == 0
    said = capsys.readouterr().out
    assert (
        "1: PLC_TENSION.UnwindTension: 24 bits signed, factor 0.001, unit N, -8388 to 8388" in said
    )
    assert "unwind_radius_m: scale 1 mm, by its unit in the file" in said
    assert main(begun(tmp_path, "canopen", replace="yes")) == 0
    said = capsys.readouterr().out
    assert "1: unwind_drive.0x2010: 32 bits signed, called Web tension, no unit" in said


def test_two_drives_that_show_a_velocity_are_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(begun(tmp_path, "canopen", signal__line_speed_m_s=None)) == 2
    assert "no answer to signal.line_speed_m_s" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"signal__status": "PLC_STATUS.Statu"}, "Did you mean PLC_STATUS.Status?"),
        ({"signal__status": "PLC_STATUS.PlcHeartbeat"}, "is something else already."),
        ({"sent__state": "PLC_SLOW.TensionRef"}, "is something else already."),
        ({"signal__status": "PLC_TENSION.UnwindTension"}, "cannot be it: It needs whole counts"),
        ({"sent__correction__unwind": "AFF_UNWIND.State"}, "It needs a signed whole signal"),
        ({"signal__status": "99"}, "write 1 to "),
        ({"unwind_angle_rad__scale": "4096 mm"}, "is a length"),
        ({"unwind_angle_rad__scale": "0"}, "0 would make every value 0"),
        ({"unwind_angle_rad__scale": "1 } #"}, "is no scale"),
        ({"scan_ms": "0"}, "write a number of ms"),
    ],
)
def test_an_answer_that_cannot_be_is_refused_at_its_line(
    changes: dict[str, str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = begun(tmp_path, "dbc", **changes)
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert said in error
    assert f"{tmp_path / 'answers.yaml'}:" in error


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"node__2": "line 3 euclid_drive.eds"}, "line 3 is a node already"),
        ({"node__2": "drive 1 euclid_drive.eds"}, "drive 1 is a node already"),
        ({"node__2": "drive 3"}, "drive: which EDS file?"),
        ({"node__2": "drive 200 euclid_drive.eds"}, "node id (1 to 127)"),
        ({"node__2": "drive 3 other.eds"}, "there is no such file"),
        ({"lost__unwind_drive": "zero"}, "write a whole number, -32768 to 32767, or none"),
    ],
)
def test_a_node_that_cannot_be_is_refused(
    changes: dict[str, str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(begun(tmp_path, "canopen", **changes)) == 2
    assert said in capsys.readouterr().err


def test_a_file_elsewhere_or_broken_is_a_clear_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = begun(tmp_path, "dbc")
    at = arguments.index("--dbc") + 1
    assert main([*arguments[:at], str(CONFIG / "euclid.dbc"), *arguments[at + 1 :]]) == 2
    assert f"is not below {tmp_path}, where the site file will be" in capsys.readouterr().err
    assert main([*arguments[:at], "none.dbc", *arguments[at + 1 :]]) == 2
    assert '--dbc: "none.dbc": there is no such file' in capsys.readouterr().err
    (tmp_path / "euclid.dbc").write_text("BO_ what\n")
    assert main(arguments) == 2
    assert f"{tmp_path / 'euclid.dbc'}:1: cannot be read as DBC" in capsys.readouterr().err


def test_a_file_without_a_heartbeat_says_what_is_missing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = begun(tmp_path, "dbc")
    dbc = 'BU_: PLC\n\nBO_ 384 T: 8 PLC\n SG_ UnwindTension : 0|16@1- (0.01,0) [0|0] "N" PLC\n'
    (tmp_path / "euclid.dbc").write_text(dbc)
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert "plc_heartbeat: no signal of the files can be the counter that the PLC raises" in said
    assert "8 bits or more" in said


def test_a_bus_that_does_not_open_leaves_the_names_alone_to_decide(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = begun(
        tmp_path, "dbc", listen="yes", interface="frame_socket", channel=str(tmp_path / "none")
    )
    assert main(arguments) == 0
    seen = capsys.readouterr()
    assert "cannot be opened" in seen.err
    assert "the names of the files alone decide" in seen.err


def test_what_was_typed_is_kept_and_again_forgets_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    begun(tmp_path, "dbc")
    site = str(tmp_path / "site.yaml")
    typed = iter(["", "", "", "no", "", "x", "", "PLC_STATUS.RollId", "q"])
    again = iter(["PLC_STATUS.Status", "q"])
    monkeypatch.setattr("builtins.input", lambda _prompt: next(typed))
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    assert main(["setup", site, "--dbc", str(tmp_path / "euclid.dbc")]) == 0
    seen = capsys.readouterr()
    assert '"x": write a number of ms' in seen.err
    draft = read_draft(tmp_path / "site.setup.json")
    assert draft.answers["signal.plc_heartbeat"] == "PLC_STATUS.PlcHeartbeat"
    assert draft.answers["signal.status"] == "PLC_STATUS.RollId"
    monkeypatch.setattr("builtins.input", lambda _prompt: next(again))
    assert main(["setup", site, "--again", "status"]) == 0
    draft = read_draft(tmp_path / "site.setup.json")
    assert draft.answers["signal.status"] == "PLC_STATUS.Status"
    assert draft.answers["wire"] == "can_dbc"


def test_a_diameter_in_inches_is_half_of_them_in_the_site_file(tmp_path: Path) -> None:
    arguments = begun(tmp_path, "dbc")
    dbc = tmp_path / "euclid.dbc"
    text = dbc.read_text().replace("UnwindRadius", "UnwindDiameter").replace('"mm"', '"in"')
    dbc.write_text(text)
    assert main(arguments) == 0
    channel = load_site(tmp_path / "site.yaml").gateway.read.channels["unwind_radius_m"]
    assert channel.scale == pytest.approx(0.5 * 0.0254)


def test_scales_that_a_display_leaves_are_round_and_make_the_count_what_is_shown() -> None:
    rows = scales_from(shown_value("20.3 lbf", "N"), 90_300.0, "N")
    scales = [text for _, text in rows]
    assert scales[0] == "0.001"  # 90.3 N is 20.30 lbf
    assert scales_from(shown_value("20.3 lbf", "N"), -90_300.0, "N")[0][1] == "-0.001"
