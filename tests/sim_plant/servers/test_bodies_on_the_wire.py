"""A line with a dancer and an accumulator on real sockets: travels are channels like others."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sim_plant.line.open import make_line
from sim_plant.servers.plc_map import PlcMap
from sim_plant.servers.words import RegisterItem
from tests.sim_plant.line.lines import declared
from tests.sim_plant.servers.fake_line import default_map
from tests.sim_plant.servers.served import ask, served, wait_until

pytestmark = pytest.mark.wire
COUNT_M = 1e-5


def travel_map() -> PlcMap:
    """The default map with both travels, i32, in place of its tensions at registers 2 and 9."""
    given = default_map()
    names = {2: "dancer_position_m", 9: "accumulator_position_m"}
    channels = tuple(
        RegisterItem(name=names[item.address], address=item.address, type="i32", scale=COUNT_M)
        for item in given.channels
        if item.address in names
    )
    unwind = tuple(c for c in given.corrections if c.item.name == "unwind")
    applied = tuple(item for item in given.applied if item.name == "unwind")
    return replace(given, channels=channels, corrections=unwind, applied=applied)


def read_travel(client, register: int) -> float:
    """Read one i32 by function 3, high word first, m."""
    answer = ask(client, f"0001 0000 0006 01 03 {register:04X} 0002", 13)
    return int.from_bytes(answer[9:13], "big", signed=True) * COUNT_M


def test_an_accumulator_is_filled_by_a_command_and_read_over_modbus():
    line = make_line(declared("coater"), seed=None)
    with served(line, plc=travel_map()) as plant, plant.client() as client:
        assert plant.command("set travel_accumulator_m_s 0.01")["ok"]
        wait_until(lambda: read_travel(client, 9) > 0.02)
        assert plant.command("set travel_accumulator_m_s 0")["ok"]
        filled = read_travel(client, 9)
        assert abs(read_travel(client, 2)) < 0.02  # the dancer stays between its stops
        shown = plant.command("value true_accumulator_position_m")["value"]
        assert shown == pytest.approx(filled, abs=0.02)
        refused = plant.command("set travel_dancer_m_s 0.01")
    assert "travel_accumulator_m_s" in refused["error"]
