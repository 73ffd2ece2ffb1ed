"""What is wrong with the plant of the demo: drawn by a seed, and in no file of its owner."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import yaml

from aff_runtime.base.errors import PlantError
from aff_runtime.base.suggest import hint
from aff_runtime.base.yaml_places import SafeLoader
from sim_plant.base.effects import Effect, Parameter, Value
from sim_plant.base.shipped import shipped
from sim_plant.demo.loop.further_words import show_further
from sim_plant.demo.wires import SITES, wire_up
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.arrays.locations import candidate_locations, zones
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.reading.load import load_declaration

LINE = shipped("lines/euclid.yaml")
IDLER = "eccentric_roller"
SIZES = (2.0, 4.0)
"""Of the change that a typical effect of the catalogue makes; within what a number may be."""
ECCENTRIC_M = (2e-4, 4e-4)
ROLL_M = (1e-3, 2e-3)
PLACES = 7
"""Decimal places of what is drawn."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hidden:
    """One effect of the plant: its name, where it is, and how large."""

    effect: str
    location: str
    parameters: Mapping[str, Value]

    def entry(self) -> dict[str, str | dict[str, Value]]:
        """Return the entry of a line declaration."""
        return {
            "effect": self.effect,
            "location": self.location,
            "parameters": dict(self.parameters),
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class Files:
    """What plant and service are started with, and what their owner knows.

    Attributes
    ----------
    line : the owner's declaration. plant : the same with what is hidden.
    site : of the service. plc : the PLC's words: registers, on CAN signals.
    plant_arguments : of the wire, and the PLC's words.
    """

    line: Path
    plant: Path
    site: Path
    plc: Path
    plant_arguments: tuple[str, ...]


def drawn(name: str, seed: int) -> tuple[Hidden, Hidden]:
    """Return the roll that is not round, and one effect of the catalogue; by ``seed``.

    Raises
    ------
    PlantError
        When the catalogue has no such effect.
    """
    if name not in BY_NAME:
        raise PlantError(f"EFFECT={name}: no such effect{hint(name, sorted(BY_NAME))}")
    chance = random.Random(f"{name} {seed}")
    line = load_declaration(LINE)
    roll = Hidden(
        effect="out_of_round_roll",
        location="unwind",
        parameters={
            "shape": "ellipse",
            "size_m": round(chance.uniform(*ROLL_M), PLACES),
            "angle_rad": round(chance.uniform(0.0, math.tau), PLACES),
        },
    )
    effect = BY_NAME[name]
    place = chance.choice(_places(effect, line))
    return roll, Hidden(effect=name, location=place, parameters=_sizes(effect, chance))


def _places(effect: Effect, line: Declaration) -> list[str]:
    """Return where to put an effect: in the unwind's zone where it may be there."""
    found = candidate_locations(line, effect)
    spans = zones(line)["unwind_zone"]
    near = {"unwind_zone", *(line.rollers[k].name for k in range(spans[0], spans[-1] + 1))}
    if effect.name == IDLER:
        near -= {"unwind"}
    return [place for place in found if place in near] or found


def _sizes(effect: Effect, chance: random.Random) -> dict[str, Value]:
    """Return parameters some times as large as is typical; an angle is any."""
    if effect.name == IDLER:
        return {
            "eccentricity_m": round(chance.uniform(*ECCENTRIC_M), PLACES),
            "angle_rad": round(chance.uniform(0.0, math.tau), PLACES),
        }
    pairs = {name for pair in effect.quadratures for name in (pair.cos, pair.sin)}
    first = effect.quadratures[:1]
    by_angle = bool(first and first[0].amplitude)
    strong = [name for name, one in effect.accepts.items() if one.role == "strength"]
    names = (first[0].amplitude, first[0].angle) if by_angle else (effect.fitted or strong)
    wanted = [name for name in names if not by_angle or name not in pairs]
    return {name: _drawn(effect.accepts[name], chance) for name in wanted}


def _drawn(parameter: Parameter, chance: random.Random) -> Value:
    if parameter.role == "angle":
        return round(chance.uniform(0.0, math.tau), PLACES)
    default = parameter.default
    if isinstance(default, str):
        return default
    change = (parameter.typical - float(default)) * chance.uniform(*SIZES)
    return round(min(max(float(default) + change, parameter.low), parameter.high), PLACES)


def write_files(folder: Path, hidden: tuple[Hidden, ...], wire: str = "modbus") -> Files:
    """Write line, plant, site and PLC files; the plant's alone has what is hidden.

    The plant also tells the true angle of every idler, to its own record only.

    Raises
    ------
    PlantError
        The demo has no such wire.
    """
    if wire not in SITES:
        raise PlantError(f"WIRE={wire}: no such wire{hint(wire, sorted(SITES))}")
    wired = wire_up(wire, shipped(SITES[wire]), folder)
    option, plc = show_further(wire, wired, folder)
    line = LINE.read_text(encoding="utf-8")
    data = yaml.load(line, Loader=SafeLoader)
    data["effects"] = [one.entry() for one in hidden]
    data["sensors"] += [
        {"channel": angle_of(roller["name"]), "roller": roller["name"], "lsb_rad": 1e-6}
        for roller in data["rollers"]
        if roller["kind"] == "idler"
    ]
    paths = [folder / name for name in ("line.yaml", "plant.yaml")]
    for path, text in zip(paths, (line, yaml.safe_dump(data, sort_keys=False)), strict=True):
        path.write_text(text, encoding="utf-8")
    return Files(
        line=paths[0],
        plant=paths[1],
        site=wired.site,
        plc=plc,
        plant_arguments=(*wired.plant_arguments, option, str(plc)),
    )


def angle_of(roller: str) -> str:
    """Return the channel of a roller's angle."""
    return f"{roller.lower()}_angle_rad"
