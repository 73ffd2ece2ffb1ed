"""Words that the shipped PLC does not show and the demo's does: a speed reference, more readings.

The line has two load cells and three drives' speeds that no correction needs. Its owner maps them
for the record alone, and so refine has them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.base.shipped import shipped
from sim_plant.demo.wires import BESIDE, Wired

REFERENCE = "line_speed_ref_m_s"
WORDS = {
    REFERENCE: "{at}: 18, type: i16, scale: 0.001",
    "r3_tension_N": "{at}: 19, type: i32, scale: 0.001",
    "rewind_tension_N": "{at}: 21, type: i32, scale: 0.001",
    "unwind_speed_rad_s": "{at}: 23, type: i16, scale: 0.001",
    "rewind_speed_rad_s": "{at}: 24, type: i16, scale: 0.001",
    "pull_roll_speed_m_s": "{at}: 25, type: i16, scale: 0.0001",
}
"""On Modbus; ``at`` is the word for a register."""
SIGNALS = {
    REFERENCE: "PLC_FURTHER.LineSpeedRef",
    "r3_tension_N": "PLC_FURTHER.R3Tension",
    "rewind_tension_N": "PLC_FURTHER.RewindTension",
}
"""On CAN; at 500 kbit/s there is room for one frame more."""
SPEED_MAX = "  # Highest speed of normal operation"
ENCODERS = "      # Encoders: counts of one turn"
FRAME = """BO_ 389 PLC_FURTHER: 8 PLC
 SG_ LineSpeedRef : 0|16@1- (0.001,0) [-32.768|32.767] "m/s" AFF
 SG_ Counter : 16|8@1+ (1,0) [0|255] "" AFF
 SG_ R3Tension : 24|24@1- (0.001,0) [-8388|8388] "N" AFF
 SG_ RewindTension : 48|16@1+ (0.01,0) [0|655.35] "N" AFF

"""


def show_further(wire: str, wired: Wired, folder: Path) -> tuple[str, Path]:
    """Add the words to the site's copy and to copies of the PLC's own files.

    Returns
    -------
    the plant's option for such a file, and the copy of the PLC's own.

    Raises
    ------
    PlantError
        The demo has no such wire, or a shipped file is not as expected.
    """
    if wire not in _WIRES:
        raise PlantError(f"WIRE={wire}: this demo runs on {' or '.join(_WIRES)}")
    return _WIRES[wire](wired.site, folder)


def _on_modbus(site: Path, folder: Path) -> tuple[str, Path]:
    _map_in_site(site, _rows(WORDS, 6, at="register"))
    plc = shipped("plc/gateway_block.yaml").read_text(encoding="utf-8")
    shown = _rows(WORDS, 4, at="address")
    path = folder / BESIDE
    path.write_text(_once(plc, "  applied:   ", f"{shown}  applied:   "), encoding="utf-8")
    return "--plc", path


def _on_can(site: Path, folder: Path) -> tuple[str, Path]:
    named = {name: f"signal: {signal}" for name, signal in SIGNALS.items()}
    _map_in_site(site, _rows({n: f"{text}, scale: 1" for n, text in named.items()}, 6))
    described = folder / "euclid.dbc"
    text = described.read_text(encoding="cp1252")
    described.write_text(_once(text, "BO_ 512 AFF", f"{FRAME}BO_ 512 AFF"), encoding="cp1252")
    rows = shipped("plc/can_dbc.yaml").read_text(encoding="utf-8")
    rows = _once(rows, "dbc: ../euclid.dbc", f"dbc: {described.name}")
    rows = _once(rows, "applied:\n", f"{_rows(named, 2)}applied:\n")
    path = folder / "can_map.yaml"
    path.write_text(rows, encoding="utf-8")
    return "--can-map", path


def _rows(words: Mapping[str, str], indent: int, at: str = "") -> str:
    """Return one line of YAML per word."""
    return "".join(
        f"{' ' * indent}{name}: {{ {text.format(at=at)} }}\n" for name, text in words.items()
    )


_WIRES: Mapping[str, Callable[[Path, Path], tuple[str, Path]]] = {
    "modbus": _on_modbus,
    "can": _on_can,
}


def _map_in_site(site: Path, rows: str) -> None:
    text = site.read_text(encoding="utf-8")
    text = _once(text, SPEED_MAX, f"  speed_reference: {REFERENCE}\n{SPEED_MAX}")
    site.write_text(_once(text, ENCODERS, rows + ENCODERS), encoding="utf-8")


def _once(text: str, old: str, new: str) -> str:
    if text.count(old) != 1:
        raise PlantError(f"{old.strip()!r} is expected once in the shipped file")
    return text.replace(old, new)
