"""Plants that the technician commissions at a terminal: those whose words are searched."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from sim_plant.demo.unusual_plants import PLANTS as ALL
from sim_plant.demo.unusual_plants import UnusualPlant, with_channels

FURTHER: Mapping[str, str] = {
    "line_speed_ref_m_s": "{ address: 18, type: i16, scale: 0.001 }",
    "r3_tension_N": "{ address: 19, type: i32, scale: 0.001 }",
    "rewind_tension_N": "{ address: 21, type: i32, scale: 0.001 }",
    "unwind_speed_rad_s": "{ address: 23, type: i16, scale: 0.001 }",
    "rewind_speed_rad_s": "{ address: 24, type: i16, scale: 0.001 }",
    "pull_roll_speed_m_s": "{ address: 25, type: i16, scale: 0.001 }",
}
"""Words that the shipped map has not: the speed's set point, and what refine uses beside."""
PLANTS: Mapping[str, UnusualPlant] = {
    name: replace(plant, plc=(with_channels(FURTHER), *plant.plc))
    for name, plant in ALL.items()
    if plant.wire == "modbus"
}
