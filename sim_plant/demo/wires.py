"""The demo's wires: which site file, what the plant is told, what the site's copy is told."""

from __future__ import annotations

import shutil
import socket
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aff_runtime.base.errors import PlantError
from sim_plant.base.shipped import shipped
from sim_plant.base.yaml_edit import value_at, with_values
from sim_plant.line.yaml_file import parse_yaml

MODBUS = "modbus"
SITES = {MODBUS: "euclid.yaml", "can": "euclid_can.yaml", "canopen": "euclid_canopen.yaml"}
FILM_SITES = {MODBUS: "film.yaml", "can": "film_can.yaml"}
_PLC_MAP = "plc/gateway_block.yaml"
_PLC_ROW = ("write", "corrections", "unwind")
_PROTOCOL = {"can": "dbc", "canopen": "canopen"}
_GATEWAY = {"can": "can_dbc", "canopen": "canopen_402"}
_DESCRIPTIONS = ("*.dbc", "*.eds")
PROBE_KEYS = ("amplitude_m_s", "duration_s")
WORD = 2**15 - 1  # counts that a correction can have
BESIDE = "plc.yaml"
"""A PLC's map beside a Modbus site file: that of the PLC whose words the file was written from."""


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
    site file, slew limit and probe in proportion, and in a copy of the PLC's map. Without it a
    site file that allows more than that map does gets a PLC that allows as much. The map is the
    shipped one, on Modbus that ``BESIDE`` the site file where there is one.

    Raises
    ------
    PlantError
        The site file is not for this wire, or the limit is none that the PLC's word can carry.
    """
    values: dict[tuple[str, ...], str | float]
    arguments: tuple[str, ...]
    plc_map, beside = shipped(_PLC_MAP), site.parent / BESIDE
    if wire == MODBUS:
        plc_map = beside if beside.exists() else plc_map
        port = free_port()
        values = {("gateway", "modbus_tcp", "port"): port}
        arguments = ("--modbus", f"127.0.0.1:{port}")
    else:
        line = folder / "can.sock"
        place = ("gateway", _GATEWAY[wire])
        values = {(*place, "interface"): "frame_socket", (*place, "channel"): str(line)}
        arguments = ("--can", _PROTOCOL[wire], "--channel", str(line))
        for pattern in _DESCRIPTIONS:
            for described in site.parent.glob(pattern):
                shutil.copy(described, folder)
    text = site.read_text(encoding="utf-8")
    data, _ = parse_yaml(text, str(site))
    if limit_m_s is not None:
        values |= _limited(data, limit_m_s, site)
    allowed_m_s = limit_m_s if limit_m_s is not None else _wider_limit(data, plc_map)
    if allowed_m_s is not None:
        arguments += ("--plc", str(_plc_with_limit(plc_map, allowed_m_s, folder)))
    elif plc_map == beside:
        arguments += ("--plc", str(beside))
    copy = folder / site.name
    try:
        copy.write_text(with_values(text, values), encoding="utf-8")
    except KeyError as error:
        raise PlantError(f"{site}: expected {error} with keys below it, for {wire}") from None
    return Wired(site=copy, plant_arguments=arguments)


def _wider_limit(site: Any, plc_map: Path) -> float | None:
    """Return the limit of a site's first actuator, where the PLC's is smaller."""
    own = value_at(site, (*_first_actuator(site), "limit_m_s"))
    if isinstance(own, bool) or not isinstance(own, int | float):
        return None
    return float(own) if own > _of_plc(plc_map, "limit_m_s") else None


def _first_actuator(site: Any) -> tuple[str, ...]:
    """Return the place of a site's first actuator; of none where it has none."""
    actuators = value_at(site, ("actuators",))
    first = next(iter(actuators), "") if isinstance(actuators, dict) else ""
    return ("actuators", str(first))


def _of_plc(plc_map: Path, key: str) -> float:
    """Return a number of the unwind's correction in a PLC's map."""
    rows = parse_yaml(plc_map.read_text(encoding="utf-8"), str(plc_map))[0]
    return _number(rows, (*_PLC_ROW, key), plc_map)


def _limited(site: Any, limit_m_s: float, path: Path) -> dict[tuple[str, ...], str | float]:
    """Return another limit of a site's first actuator and what suits it, each at its place.

    The slew limit follows in proportion. So does the probe, in amplitude and in time: what more
    room is for are orders of high frequency and little response, and those need a surer one.
    """
    actuator = _first_actuator(site)
    places: list[tuple[str, ...]] = [(*actuator, key) for key in ("limit_m_s", "slew_m_s2")]
    places += [("probe", key) for key in PROBE_KEYS]
    numbers = {place: _number(site, place, path) for place in places}
    ratio = limit_m_s / numbers[places[0]]
    return {place: float(f"{number * ratio:g}") for place, number in numbers.items()}


def _number(site: Any, place: tuple[str, ...], path: Path) -> float:
    found = value_at(site, place)
    if isinstance(found, bool) or not isinstance(found, int | float):
        what = f"expected '{place[-1]}:' with a number in SI"
        raise PlantError(f"{path}: {what}, which --limit-m-s changes")
    return float(found)


def _plc_with_limit(plc_map: Path, limit_m_s: float, folder: Path) -> Path:
    """Copy a PLC's map into ``folder`` with another limit of the unwind's correction."""
    most = _of_plc(plc_map, "scale") * WORD
    if not 0.0 < limit_m_s <= most:
        raise PlantError(
            f"limit {limit_m_s:g} m/s: give above 0 to {most:.3g} m/s, what the word "
            f"of the correction can carry ({plc_map.name})"
        )
    copy = folder / plc_map.name
    text = plc_map.read_text(encoding="utf-8")
    limited = with_values(text, {(*_PLC_ROW, "limit_m_s"): limit_m_s})
    copy.write_text(limited, encoding="utf-8")
    return copy
