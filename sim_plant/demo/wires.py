"""The demo's wires: which site file, what the plant is told, what the site's copy is told."""

from __future__ import annotations

import re
import shutil
import socket
from dataclasses import dataclass
from pathlib import Path

from aff_runtime.base.errors import PlantError

SITES = {"modbus": "euclid.yaml", "can": "euclid_can.yaml", "canopen": "euclid_canopen.yaml"}
FILM_SITES = {"modbus": "film.yaml", "can": "film_can.yaml"}
_PROTOCOL = {"can": "dbc", "canopen": "canopen"}
_DESCRIPTIONS = ("*.dbc", "*.eds")


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


def wire_up(wire: str, site: Path, folder: Path) -> Wired:
    """Copy the site file into ``folder`` with a port, or a serial line, of our own.

    Raises
    ------
    PlantError
        The site file is not for this wire.
    """
    text = site.read_text(encoding="utf-8")
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
    return Wired(site=copy, plant_arguments=arguments)


def _replaced(text: str, pattern: str, new: str, site: Path) -> str:
    text, found = re.subn(pattern, new, text)
    if found != 1:
        key = new.partition(":")[0].strip()
        raise PlantError(f"{site}: expected one '{key}:', found {found}")
    return text
