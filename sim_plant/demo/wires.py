"""The demo's wires: which site file, what the plant is told, what the site's copy is told."""

from __future__ import annotations

import re
import shutil
import socket
from dataclasses import dataclass
from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.base.shipped import shipped

SITES = {"modbus": "euclid.yaml", "can": "euclid_can.yaml", "canopen": "euclid_canopen.yaml"}
FILM_SITES = {"modbus": "film.yaml", "can": "film_can.yaml"}
_PROTOCOL = {"can": "dbc", "canopen": "canopen"}
_DESCRIPTIONS = ("*.dbc", "*.eds")
PROBE_KEYS = ("amplitude_m_s", "duration_s")
WORD = 2**15 - 1  # counts that a correction can have


@dataclass(frozen=True, slots=True, kw_only=True)
class Wired:
    """One wire, ready to use.

    Attributes
    ----------
    site : copy of the site file that reaches this bench's plant.
    plant_arguments : what ``sim-plant serve`` needs for this wire.
    """

    site: Path
    plant_arguments: tuple[str, ...]


def free_port() -> int:
    """Return a TCP port that is free on loopback now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def wire_up(wire: str, site: Path, folder: Path, limit_m_s: float | None = None) -> Wired:
    """Copy the site file into ``folder`` with a port, or a serial line, of our own.

    ``limit_m_s`` becomes the limit of the unwind's correction, on both sides: in the copy of the
    site file, slew limit and probe in proportion, and in a copy of the PLC's map.

    Raises
    ------
    PlantError
        The site file is not for this wire, or the limit is none that the PLC's word can carry.
    """
    text = site.read_text(encoding="utf-8")
    limited: tuple[str, ...] = ()
    if limit_m_s is not None:
        text = _with_limit(text, limit_m_s, site)
        limited = ("--plc", str(_plc_with_limit(limit_m_s, folder)))
    arguments: tuple[str, ...]
    if wire == "modbus":
        port = free_port()
        text = _replaced(text, r"port: \d+", f"port: {port}", site)
        arguments = ("--modbus", f"127.0.0.1:{port}")
    else:
        line = folder / "can.sock"
        text = _replaced(text, r"(?m)^    interface: \w+", "    interface: frame_socket", site)
        text = _replaced(text, r"(?m)^    channel: \w+", f"    channel: {line}", site)
        arguments = ("--can", _PROTOCOL[wire], "--channel", str(line))
        for pattern in _DESCRIPTIONS:
            for described in site.parent.glob(pattern):
                shutil.copy(described, folder)
    copy = folder / site.name
    copy.write_text(text, encoding="utf-8")
    return Wired(site=copy, plant_arguments=(*arguments, *limited))


def _with_limit(text: str, limit_m_s: float, site: Path) -> str:
    """Return the site file with another limit of its first actuator and what suits it.

    The slew limit follows in proportion. So does the probe, in amplitude and in time: what more
    room is for are orders of high frequency and little response, and those need a surer one.
    """
    names = list(re.finditer(r"(?m)^(?:actuators|  \w+):$", text))
    at = next((i for i, name in enumerate(names) if name[0] == "actuators:"), len(names))
    first, end = [*(name.start() for name in names[at + 1 : at + 3]), len(text), len(text)][:2]
    limit = _number(text, "    limit_m_s", (first, end), site)
    ratio = limit_m_s / float(limit[1])
    others = [_number(text, "    slew_m_s2", (first, end), site)]
    others += [_number(text, f"  {k}", (end, len(text)), site) for k in PROBE_KEYS]
    for match in sorted((limit, *others), key=lambda match: -match.start()):
        scaled = float(match[1]) * ratio
        text = f"{text[: match.start(1)]}{scaled:g}{text[match.end(1) :]}"
    return text


def _number(text: str, key: str, place: tuple[int, int], site: Path) -> re.Match[str]:
    found = re.compile(rf"^{key}: ([\d.]+)$", re.MULTILINE).search(text, *place)
    if found is None:
        what = f"expected '{key.strip()}:' with a number in SI"
        raise PlantError(f"{site}: {what}, which --limit-m-s changes")
    return found


def _plc_with_limit(limit_m_s: float, folder: Path) -> Path:
    """Copy the PLC's map into ``folder`` with another limit of the unwind's correction."""
    shipped_map = shipped("plc/gateway_block.yaml")
    text = shipped_map.read_text(encoding="utf-8")
    row = re.search(r"(?m)^    unwind: .* scale: ([\d.]+), limit_m_s: ([\d.]+) }$", text)
    if row is None:
        raise PlantError(f"{shipped_map}: expected one 'unwind:' with scale and limit_m_s")
    most = float(row[1]) * WORD
    if not 0.0 < limit_m_s <= most:
        raise PlantError(
            f"limit {limit_m_s:g} m/s: give above 0 to {most:.3g} m/s, what the word "
            f"of the correction can carry ({shipped_map.name})"
        )
    copy = folder / shipped_map.name
    copy.write_text(f"{text[: row.start(2)]}{limit_m_s:g}{text[row.end(2) :]}", encoding="utf-8")
    return copy


def _replaced(text: str, pattern: str, new: str, site: Path) -> str:
    text, found = re.subn(pattern, new, text)
    if found != 1:
        key = new.partition(":")[0].strip()
        raise PlantError(f"{site}: expected one '{key}:', found {found}")
    return text
