"""What is said of a file that is no good EDS: its real path, the line, plain text."""

from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.base.errors import ConfigError
from aff_runtime.cli.main import main
from aff_runtime.fieldbus.canopen.eds_file import load_eds
from tests.aff_runtime.config.shipped import copied
from tests.each_case import each_case

CONFIG = Path(__file__).parents[4] / "config"
EDS = (CONFIG / "euclid_drive.eds").read_text()


def test_rubbish_is_no_eds() -> None:
    with pytest.raises(ConfigError, match=r"^x\.eds:1: cannot be read as EDS: this line st"):
        load_eds("no section\n", "x.eds", 3)


def said_of(text: str) -> str:
    with pytest.raises(ConfigError) as caught:
        load_eds(text, "drive.eds", 3)
    return str(caught.value)


@each_case(
    ("was", "now", "at", "said"),
    [
        ("[1A00]\n", "[1A00]\nnonsense\n", "nonsense", "neither [section] nor key=value"),
        ("[1A00]\n", "[DeviceInfo]\n[1A00]\n", "[DeviceInfo]", "[DeviceInfo] comes a second time"),
        (
            "[1A00]\n",
            "[1A00]\nTwice=1\nTwice=1\n",
            "Twice=1",
            "Twice comes a second time in section [1A00]",
        ),
        ("[1A00]\nParameterName", "[1A00]\nNamed", "[1A00]", "[1A00] has no ParameterName"),
        (
            "[1A00]\n",
            "[1A00]\nParameterName=x\nObjectType=many\n[Rest]\n",
            "ObjectType=many",
            "'many' is no number",
        ),
    ],
)
def test_every_fault_is_told_by_its_line(was: str, now: str, at: str, said: str) -> None:
    assert EDS.count(was) == 1
    text = EDS.replace(was, now)
    row = max(n for n, line in enumerate(text.splitlines(), 1) if line == at)
    told = said_of(text)
    assert told.startswith(f"drive.eds:{row}: cannot be read as EDS: ")
    assert said in told
    assert "\n" not in told


def test_check_names_the_real_file_its_line_and_no_escapes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    copied(tmp_path)
    site = tmp_path / "euclid_canopen.yaml"
    old, new = "eds: euclid_line.eds", "eds: euclid.dbc"
    assert old in site.read_text()
    site.write_text(site.read_text().replace(old, new, 1))
    assert main(["check", str(site)]) == 2
    told = capsys.readouterr().err
    assert f"{tmp_path / 'euclid.dbc'}:1: cannot be read as EDS: " in told
    assert "\\n" not in told
    assert "euclid.dbc.eds" not in told


def test_check_names_the_real_file_and_line_of_a_spoilt_dbc(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    copied(tmp_path)
    dbc = tmp_path / "euclid.dbc"
    lines = dbc.read_text().splitlines()
    row = next(n for n, line in enumerate(lines, 1) if line.startswith(" SG_"))
    lines[row - 1] = " SG_ ! nonsense"
    dbc.write_text("\n".join(lines))
    assert main(["check", str(tmp_path / "euclid_can.yaml")]) == 2
    assert f"{dbc}:{row}: cannot be read as DBC " in capsys.readouterr().err
