"""What a run's own copy of the site file says about its columns; plain reading, no judgement."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from aff_runtime.base.channel_units import unit_of_name
from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable, text_or
from aff_runtime.base.runs.counted_angle import modulus_rad
from aff_runtime.base.runs.files import yaml_values
from aff_runtime.base.units import UnitError, read_scale
from aff_runtime.base.yaml_section import Section

DEFAULT_SPEED = "line_speed_m_s"
FLOAT = "f32"
UNITS = {"velocity_reference": ("m/s", "m_s"), "torque_reference": ("N m", "N_m")}
"""What an actuator's output is counted in: symbol, and end of its columns' names."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunActuator:
    """One actuator of the site file.

    Attributes
    ----------
    suffix : end of its columns' names, ``m_s`` or ``N_m``.
    signal, reference : channels of what it keeps quiet; reference empty where none is mapped.
    count : correction in one count of its word, SI; 0 where the file does not say.
    roll : roll that its declared drive turns; empty without one.
    transport_s : declared time from a snapshot to its correction at the drive; None without.
    """

    suffix: str
    signal: str
    reference: str
    count: float
    roll: str
    transport_s: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSite:
    """The site file of a run, as far as its columns need it.

    Attributes
    ----------
    name : of the line. ``cycle_s`` : its cycle; 0 where it is not said.
    speed : channel of the line speed; ``speed_reference`` that of its set point, or empty.
    rolls : per roll its channels by use (``angle``, ``speed``, ``radius``).
    actuators : by name.
    needed : channels that the service's corrections wait for; others are for the record alone.
    count_sizes : per channel one count of its word, SI; where the scale is a factor of what a DBC
        gives, or of a float, that factor: see ``word_steps.one_count``.
    registers_rad : per channel that ``wraps``, what its register holds, rad; none of a CAN signal,
        whose length is in the DBC alone.
    """

    name: str
    speed: str
    speed_reference: str
    rolls: Mapping[str, Mapping[str, str]]
    actuators: Mapping[str, RunActuator]
    needed: frozenset[str]
    count_sizes: Mapping[str, float]
    cycle_s: float = 0.0
    registers_rad: Mapping[str, float] = field(default_factory=dict)


def run_site(text: str, where: str) -> RunSite:
    """Return what the site file in ``text`` says; ``where`` names it in errors.

    Raises
    ------
    PlantError
        It is missing, or no site file.
    """
    if not text.strip():
        raise PlantError(
            f"{where}: is not there, empty, or closed to you; put the site file of that run there"
        )
    try:
        data = yaml_values(text)
        line, gateway = data["line"], data["gateway"]
        channels, written = gateway["read"]["channels"], gateway["write"]["corrections"]
        return RunSite(
            name=printable(text_or(line.get("name"))),
            cycle_s=1e-3 * _number(line.get("cycle_ms"), "ms", 0.0),
            speed=text_or(line.get("speed"), DEFAULT_SPEED),
            speed_reference=text_or(line.get("speed_reference")),
            rolls={str(name): _channels(roll) for name, roll in data["rolls"].items()},
            actuators={
                str(name): _actuator(given, written.get(name) or {})
                for name, given in data["actuators"].items()
            },
            needed=_needed(data),
            count_sizes={
                str(name): abs(_number(row.get("scale"), unit_of_name(str(name)), 0.0))
                for name, row in channels.items()
            },
            registers_rad={
                str(name): register_rad
                for name, row in channels.items()
                if math.isfinite(register_rad := modulus_rad(Section.of(row)))
            },
        )
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        said = printable(_what_it_lacks(error), 160)
        raise PlantError(
            f"{where}: does not say what the columns of the run are ({said}); put the site file "
            "of that run in its place"
        ) from None


def _what_it_lacks(error: Exception) -> str:
    if isinstance(error, KeyError):
        return f"{error} is missing, or no word that is known there"
    if isinstance(error, ValueError):
        return str(error)
    return "a section holds something else than keys with values"


def _needed(data: Any) -> frozenset[str]:
    """Return what the line, rolls, errors and believable ranges of the file name."""
    names = {text_or(data["line"].get("speed"), DEFAULT_SPEED)}
    names |= {str(name) for name in data.get("plausibility") or {}}
    for roll in data["rolls"].values():
        names |= {text_or(roll.get(use)) for use in ("angle", "speed", "line_speed", "radius")}
    for actuator in data["actuators"].values():
        names |= {text_or(actuator["error"].get(use)) for use in ("signal", "reference")}
    return frozenset(names) - {""}


def _channels(roll: Mapping[str, Any]) -> dict[str, str]:
    return {
        use: text_or(roll.get(use))
        for use in ("angle", "speed", "radius")
        if text_or(roll.get(use))
    }


def _actuator(given: Mapping[str, Any], written: Mapping[str, Any]) -> RunActuator:
    unit, suffix = UNITS[given["output"]]
    drive = given.get("drive") or {}
    transport = drive.get("transport_ms")
    return RunActuator(
        suffix=suffix,
        signal=text_or(given["error"]["signal"]),
        reference=text_or(given["error"].get("reference")),
        # a float comes as it was sent: its scale is a factor, not a count
        count=0.0 if written.get("type") == FLOAT else _number(written.get("scale"), unit, 0.0),
        roll=text_or(drive.get("roll")),
        transport_s=None if transport is None else 1e-3 * _number(transport, "ms", 0.0),
    )


def _number(value: object, unit: str, absent: float) -> float:
    """Return a number or scale of the file in ``unit``; ``absent`` where it is none."""
    try:
        return read_scale(value, unit) if value is not None else absent
    except UnitError:
        return absent
