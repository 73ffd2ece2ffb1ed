"""The optional echo: which sites have it, which are told, and how old it may be."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from aff_runtime.app.wiring.site_to_guard import guard_params
from aff_runtime.app.wiring.site_to_wire import register_map
from aff_runtime.base.errors import ConfigError
from aff_runtime.config.can_wire import can_map_of, wire_files
from aff_runtime.config.loader import load_site, read_site
from tests.aff_runtime.config.shipped import EUCLID, edited, without_applied

CONFIG = EUCLID.parent
ECHO = "    aff_echo: { register: 15 }\n"


def warnings_of(path: Path) -> dict[str, str]:
    return {finding.path: finding.text for finding in read_site(path).warnings}


def test_a_site_without_the_echo_is_valid_and_told_what_it_cannot_see(tmp_path: Path) -> None:
    path = edited(tmp_path, (ECHO, ""))
    path.write_text(without_applied(path.read_text()))
    said = warnings_of(path)["gateway.read"]
    assert "a second master that always writes last" in said
    assert register_map(load_site(tmp_path / "site.yaml")).aff_echo is None
    assert "gateway.read" not in warnings_of(edited(tmp_path))


def test_the_echo_is_a_word_of_the_read_block_that_nobody_else_has(tmp_path: Path) -> None:
    assert register_map(load_site(edited(tmp_path))).aff_echo == 15
    with pytest.raises(ConfigError, match="register is missing; modbus_tcp needs it"):
        load_site(edited(tmp_path, (ECHO, "    aff_echo: { signal: PLC.Echo }\n")))
    with pytest.raises(ConfigError, match=r"wire address 8 is taken by gateway\.read\.roll_id"):
        load_site(edited(tmp_path, (ECHO, "    aff_echo: { register: 8 }\n")))


@pytest.mark.parametrize(("cycle_ms", "ticks"), [(5, 50), (7, 37), (26, 12)])
def test_an_echo_may_take_three_times_what_a_plc_may_be_silent(
    cycle_ms: int, ticks: int, tmp_path: Path
) -> None:
    # 240 ms / 5 ms = 48; 240 / 7 = 34.3; 240 / 26 = 9.2; and two ticks
    path = edited(tmp_path, ("cycle_ms: 5", f"cycle_ms: {cycle_ms}"))
    echo = guard_params(load_site(path)).echo
    assert (echo.ticks, echo.missing_after_s) == (ticks, pytest.approx(0.08))


@pytest.mark.parametrize("name", ["euclid_can.yaml", "euclid_canopen.yaml"])
def test_a_bus_without_the_echo_is_as_good_as_before(folder: Path, name: str) -> None:
    path = folder / name
    lines = without_applied(path.read_text()).splitlines(keepends=True)
    path.write_text("".join(line for line in lines if "aff_echo: {" not in line))
    reading = read_site(path)
    assert not [f for f in reading.warnings if "echo" in f.text]  # everybody's frames are heard
    frames = can_map_of(reading.site, wire_files(reading.site, folder))
    assert frames.aff_echo is None
    assert not [frame for frame in frames.frames if frame.name == "line.TPDO3"]


def test_an_echo_that_holds_a_part_of_the_heartbeat_is_refused(folder: Path) -> None:
    dbc = folder / "euclid.dbc"
    dbc.write_text(dbc.read_text().replace("AffEcho : 48|16@1+", "AffEcho : 48|8@1+"))
    said = "PLC_STATUS.AffEcho: has 8 bits, but must hold all of aff_heartbeat"
    with pytest.raises(ConfigError, match=re.escape(said)):
        load_site(folder / "euclid_can.yaml")
