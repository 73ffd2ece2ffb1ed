"""The speed reference, which the shipped PLC does not show: the demo's PLC does, by wire."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.base.shipped import shipped
from sim_plant.demo.wires import Wired

REFERENCE = "line_speed_ref_m_s"
SPEED_MAX = "  # Highest speed of normal operation"
ENCODERS = "      # Encoders: counts of one turn"
FRAME = """BO_ 389 PLC_REFERENCE: 3 PLC
 SG_ LineSpeedRef : 0|16@1- (0.001,0) [-32.768|32.767] "m/s" AFF
 SG_ Counter : 16|8@1+ (1,0) [0|255] "" AFF

"""


def show_reference(wire: str, wired: Wired, folder: Path) -> tuple[str, Path]:
    """Add the word to the site's copy and to copies of the PLC's own files.

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
    word = "register: 18, type: i16, scale: 0.001"
    _map_in_site(site, word)
    plc = shipped("plc/gateway_block.yaml").read_text(encoding="utf-8")
    shown = f"    {REFERENCE}: {{ {word.replace('register', 'address')} }}\n"
    path = folder / "plc.yaml"
    path.write_text(_once(plc, "  applied:   ", f"{shown}  applied:   "), encoding="utf-8")
    return "--plc", path


def _on_can(site: Path, folder: Path) -> tuple[str, Path]:
    signal = "signal: PLC_REFERENCE.LineSpeedRef"
    _map_in_site(site, f"{signal}, scale: 1")
    described = folder / "euclid.dbc"
    text = described.read_text(encoding="cp1252")
    described.write_text(_once(text, "BO_ 512 AFF", f"{FRAME}BO_ 512 AFF"), encoding="cp1252")
    rows = shipped("plc/can_dbc.yaml").read_text(encoding="utf-8")
    rows = _once(rows, "dbc: ../euclid.dbc", f"dbc: {described.name}")
    rows = _once(rows, "applied:\n", f"  {REFERENCE}: {{ {signal} }}\napplied:\n")
    path = folder / "can_map.yaml"
    path.write_text(rows, encoding="utf-8")
    return "--can-map", path


_WIRES: Mapping[str, Callable[[Path, Path], tuple[str, Path]]] = {
    "modbus": _on_modbus,
    "can": _on_can,
}


def _map_in_site(site: Path, word: str) -> None:
    text = site.read_text(encoding="utf-8")
    text = _once(text, SPEED_MAX, f"  speed_reference: {REFERENCE}\n{SPEED_MAX}")
    mapped = f"      {REFERENCE}: {{ {word} }}\n"
    site.write_text(_once(text, ENCODERS, mapped + ENCODERS), encoding="utf-8")


def _once(text: str, old: str, new: str) -> str:
    if text.count(old) != 1:
        raise PlantError(f"{old.strip()!r} is expected once in the shipped file")
    return text.replace(old, new)
