"""Put declared effects on a line's arrays."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Value
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.build import cell_sensors
from sim_plant.line.declaration import Declaration, EffectEntry


def apply_effects(
    declaration: Declaration, arrays: LineArrays, entries: Iterable[EffectEntry]
) -> LineArrays:
    """Return ``arrays`` with every entry added.

    Raises
    ------
    PlantError
        On an unknown effect, location or parameter; the message offers the nearest name.
    """
    for number, entry in enumerate(entries):
        where = f"effects.{number}"
        effect = _known(BY_NAME, entry.effect, f"{where}.effect")
        values = merged(effect, entry.parameters, where)
        for place in places(declaration, arrays, effect, entry.location, where):
            arrays = effect.apply(arrays, place, values)
    return arrays


def _known(table: Mapping[str, Effect], name: str, where: str) -> Effect:
    if name not in table:
        near = difflib.get_close_matches(name, table, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise PlantError(f"{where}: read {name!r}; expected one of {sorted(table)}{hint}")
    return table[name]


def merged(effect: Effect, given: Mapping[str, Value], where: str) -> dict[str, Value]:
    """Return defaults with ``given`` on top; PlantError on an unknown or non-finite value."""
    values = dict(effect.parameters)
    for key, value in given.items():
        if key not in values:
            near = difflib.get_close_matches(key, values, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise PlantError(f"{where}.parameters: unknown key {key!r}{hint}")
        if isinstance(values[key], str):
            values[key] = str(value)
        elif isinstance(value, str | bool) or not np.isfinite(float(value)):
            raise PlantError(f"{where}.parameters.{key}: read {value!r}; expected a number")
        else:
            values[key] = float(value)
    return values


def places(
    declaration: Declaration, arrays: LineArrays, effect: Effect, location: str, where: str
) -> list[int]:
    """Return the indices that ``location`` names for this kind of effect."""
    if effect.place == "web":
        return [0]
    if effect.place == "span":
        pairs = [f"{span.start}-{span.end}" for span in declaration.spans]
        return [_index(pairs, location, f"{where}.location")]
    if effect.place == "cell":
        names = [s.roller for s in cell_sensors(declaration)]
        if location == "all":
            return list(range(len(names)))
        return [_index(names, location, f"{where}.location")]
    if effect.place == "loop":
        names = [loop.acts_on for loop in declaration.control.tension_pi]
        return [_index(names, location, f"{where}.location")]
    return [_body_or_drive(declaration, arrays, effect, location, f"{where}.location")]


def _body_or_drive(
    declaration: Declaration, arrays: LineArrays, effect: Effect, location: str, where: str
) -> int:
    body = _index([r.name for r in declaration.rollers], location, where)
    if effect.place == "body":
        return body
    drives = [int(b) for b in arrays.drives["body"]]
    if body not in drives:
        raise PlantError(f"{where}: roller {location!r} has no drive")
    return drives.index(body)


def _index(names: list[str], name: str, where: str) -> int:
    if name not in names:
        near = difflib.get_close_matches(name, names, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise PlantError(f"{where}: read {name!r}; expected one of {names}{hint}")
    return names.index(name)
