"""Plants that the technician commissions, each by what is unlike the shipped map and line."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import reduce
from pathlib import Path
from typing import Any

from sim_plant.base.shipped import shipped
from sim_plant.line.yaml_file import load_yaml

TURN = 6.283185307179586
PLC_MAP = shipped("plc/gateway_block.yaml")
LINE = shipped("lines/euclid_ripple.yaml")
FURTHER: Mapping[str, Mapping[str, Any]] = {
    "line_speed_ref_m_s": {"address": 18, "type": "i16", "scale": 0.001},
    "r3_tension_N": {"address": 19, "type": "i32", "scale": 0.001},
    "rewind_tension_N": {"address": 21, "type": "i32", "scale": 0.001},
    "unwind_speed_rad_s": {"address": 23, "type": "i16", "scale": 0.001},
    "rewind_speed_rad_s": {"address": 24, "type": "i16", "scale": 0.001},
    "pull_roll_speed_m_s": {"address": 25, "type": "i16", "scale": 0.001},
}
"""Words that the shipped map has not: the speed's set point, and what refine uses beside."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlayedPlant:
    """What is unlike the shipped plant.

    Attributes
    ----------
    plc : what the PLC's map says otherwise. ``edits`` : texts of the line file, old and new.
    fc23 : whether the PLC knows function 23.
    answers : by a part of the question, what the technician says otherwise.
    """

    plc: Mapping[str, Any] = field(default_factory=dict)
    edits: tuple[tuple[str, str], ...] = ()
    fc23: bool = True
    answers: Mapping[str, str] = field(default_factory=dict)

    def plc_map(self, folder: Path) -> Path:
        """Write the PLC's map."""
        whole, _ = load_yaml(PLC_MAP)
        more = {"read": {"channels": FURTHER}}
        path = folder / "plc.yaml"
        text = json.dumps(_merged(_merged(whole, more), self.plc))
        path.write_text(_POINTLESS.sub(r"\1.0e", text), encoding="utf-8")
        return path

    def line_file(self, folder: Path) -> Path:
        """Write the line's declaration."""
        text = LINE.read_text(encoding="utf-8")
        for old, new in self.edits:
            assert old in text, old
            text = text.replace(old, new, 1)
        path = folder / "line.yaml"
        path.write_text(text, encoding="utf-8")
        return path


def _angle(address: int, kind: str, scale: float = TURN / 4096) -> dict[str, Any]:
    return {"address": address, "type": kind, "scale": scale, "wraps": True}


def _angles(unwind: Mapping[str, Any], second: Mapping[str, Any]) -> dict[str, Any]:
    channels = {"unwind_angle_rad": unwind, "swrap_follower_angle_rad": second}
    return {"read": {"channels": channels}}


def _merged(whole: dict[str, Any], other: Mapping[str, Any]) -> dict[str, Any]:
    """Return a mapping with parts of it exchanged; a word is exchanged as a whole."""

    def put(into: dict[str, Any], item: tuple[str, Any]) -> dict[str, Any]:
        name, value = item
        kept = into.get(name)
        inner = isinstance(kept, dict) and isinstance(value, Mapping) and "address" not in value
        return {**into, name: _merged(kept or {}, value) if inner else value}

    return reduce(put, other.items(), dict(whole))


_POINTLESS = re.compile(r"(?<![\d.])(\d+)e(?=[-+]?\d)")  # YAML wants 1.0e-05
_CELL = "- channel: unwind_tension_N\n  roller: R9\n  low_pass_Hz: 20.0"
_LATE = "effects:\n- effect: loop_delay\n  location: unwind\n  parameters: {delay_s: 0.06}\n"
PLANTS: Mapping[str, PlayedPlant] = {
    "shipped": PlayedPlant(),
    "low words first": PlayedPlant(plc={"word_order": "low_first"}),
    "manual from 40001": PlayedPlant(answers={"Which number has word": "40001"}),
    "angles of one word": PlayedPlant(
        plc=_angles(_angle(11, "u16"), _angle(13, "i16", TURN / 16384))
    ),
    "encoder against the web": PlayedPlant(
        plc=_angles(_angle(11, "i32", -TURN / 4096), _angle(13, "i16", -TURN / 8192))
    ),
    "heartbeat of 10 ms": PlayedPlant(plc={"scan_ms": 10.0}),
    "functions 3 and 16": PlayedPlant(fc23=False, answers={"Function codes": "fc3_fc16"}),
    "load cell with 5 Hz": PlayedPlant(edits=((_CELL, _CELL.replace("20.0", "5.0")),)),
    "drive 60 ms late": PlayedPlant(edits=(("effects:\n", _LATE),)),
}
