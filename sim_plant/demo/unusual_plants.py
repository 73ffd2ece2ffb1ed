"""Unusual plants, each by what is unlike the shipped one: PLC, wire, line; to commission."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.base.shipped import shipped
from sim_plant.demo.wires import BESIDE

PLC_MAP = shipped("plc/gateway_block.yaml")
LINE = shipped("lines/euclid_ripple.yaml")
Edit = tuple[str, str]
"""A text of a file, which stands there once at least, and what its first stands for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class UnusualPlant:
    """What is unlike the shipped plant.

    Attributes
    ----------
    plc, line : edits of the PLC's map and of the line file.
    fc23 : whether the PLC knows function 23.
    wire : of `make demo`: how the PLC talks.
    answers : what a technician with its manual answers setup otherwise, by the question's name.
    """

    plc: tuple[Edit, ...] = ()
    line: tuple[Edit, ...] = ()
    fc23: bool = True
    wire: str = "modbus"
    answers: Mapping[str, str] = field(default_factory=dict)

    def plc_map(self, folder: Path) -> Path:
        """Return the PLC's map: the shipped one, or one in ``folder`` where it is edited."""
        return _edited(PLC_MAP, self.plc, folder / BESIDE)

    def line_file(self, folder: Path, line: Path = LINE) -> Path:
        """Return the line's declaration: ``line``, or one in ``folder`` where it is edited.

        Raises
        ------
        PlantError
            The line has not what the plant has otherwise.
        """
        return _edited(line, self.line, folder / "line.yaml")

    def serve_arguments(self, folder: Path) -> tuple[str, ...]:
        """Return what `sim-plant serve` is told of its PLC; a map is written into ``folder``."""
        own_map = ("--plc", str(self.plc_map(folder))) if self.plc else ()
        return (*own_map, *(() if self.fc23 else ("--no-fc23",)))


def with_channels(rows: Mapping[str, str]) -> Edit:
    """Return the edit that gives the PLC's map more channels, each a row such as ``{ ... }``."""
    begin = "  channels:\n"
    return begin, begin + "".join(f"    {name}: {row}\n" for name, row in rows.items())


def _edited(path: Path, edits: tuple[Edit, ...], to: Path) -> Path:
    if not edits:
        return path
    text = path.read_text(encoding="utf-8")
    for old, new in edits:
        if old not in text:
            raise PlantError(f"{path}: this plant is another one, edited; {old!r} is not there")
        text = text.replace(old, new, 1)
    to.write_text(text, encoding="utf-8")
    return to


def _counts(address: int, kind: str, scale: str) -> Edit:
    """Return the edit that lets a word, or two, count otherwise."""
    was_kind, was = _SHIPPED[address]
    begin = f"address: {address}, type: "
    return f"{begin}{was_kind}, scale: {was}", f"{begin}{kind}, scale: {scale}"


_TURN = "0.0015339807878856412"
_SHIPPED = {
    2: ("i32", "0.001"),
    4: ("u16", "0.01"),
    5: ("i16", "0.001"),
    6: ("u16", "0.00002"),
    7: ("i16", "0.001"),
    9: ("i32", "0.001"),
    11: ("i32", _TURN),
    13: ("i32", _TURN),
}
_AGAINST = (_counts(11, "i32", f"-{_TURN}"), _counts(13, "i16", "-0.0007669903939428206"))
_LOW = ("word_order: high_first", "word_order: low_first")
_BITS = (
    "status:        { address: 1 }",
    "status: { address: 1, bits: { LINE_RUN: { bit: 9 }, AFF_ENABLE_REQUEST: { bit: 2 }, "
    "WEB_INTACT: { bit: 12, inverted: true }, TENSION_VALID: { bit: 0 }, "
    "ESTOP_OK: { address: 26, bit: 7 } } }",
)
_ANGLES = ("unwind_angle_rad", "swrap_follower_angle_rad")
_CELL = "- channel: unwind_tension_N\n  roller: R9\n  low_pass_Hz: 20.0"
_LATE = "effects:\n- effect: loop_delay\n  location: unwind\n  parameters: {delay_s: 0.06}\n"
PLANTS: Mapping[str, UnusualPlant] = {
    "shipped": UnusualPlant(),
    "low words first": UnusualPlant(plc=(_LOW,)),
    "manual from 40001": UnusualPlant(answers={"number": "40001"}),
    "unsigned angles": UnusualPlant(plc=(_counts(11, "u32", _TURN), _counts(13, "u32", _TURN))),
    "angles of one word": UnusualPlant(
        plc=(_counts(11, "u16", _TURN), _counts(13, "i16", "0.0003834951969714103"))
    ),
    "encoder against the web": UnusualPlant(plc=_AGAINST),
    "low words first, against the web": UnusualPlant(
        plc=(_LOW, _AGAINST[0], _counts(13, "u32", _TURN))
    ),
    "pounds and feet": UnusualPlant(
        plc=(
            _counts(2, "i32", "0.0044482216152605"),  # 0.001 lbf
            _counts(4, "u16", "0.044482216152605"),  # 0.01 lbf
            _counts(5, "i16", "0.000508"),  # 0.1 FPM
            _counts(6, "u16", "0.0000254"),  # 0.001 in
            _counts(7, "i16", "0.000508"),
            _counts(9, "i32", "0.0044482216152605"),
        )
    ),
    "status bits of its own": UnusualPlant(
        plc=(_BITS,),
        answers={
            "status.order": "no",
            "bits.LINE_RUN": "1.9",
            "bits.AFF_ENABLE_REQUEST": "1.2",
            "bits.WEB_INTACT": "1.12 inverted",
            "bits.TENSION_VALID": "1.0",
            "bits.ESTOP_OK": "26.7",
        },
    ),
    "no encoder": UnusualPlant(
        plc=tuple((f"    {name}:", f"    #{name}:") for name in _ANGLES),
        answers={f"{name}.display": "skip" for name in _ANGLES},
    ),
    "heartbeat of 10 ms": UnusualPlant(plc=(("version: 1\n", "version: 1\nscan_ms: 10.0\n"),)),
    "functions 3 and 16": UnusualPlant(fc23=False, answers={"function": "fc3_fc16"}),
    "load cell with 5 Hz": UnusualPlant(line=((_CELL, _CELL.replace("20.0", "5.0")),)),
    "drive 60 ms late": UnusualPlant(line=(("effects:\n", _LATE),)),
    "CAN by DBC": UnusualPlant(wire="can"),
    "CANopen": UnusualPlant(wire="canopen"),
}
"""By the name that `sim-plant live --fresh --plant` takes."""
