"""Put declared effects on a line's arrays."""

from __future__ import annotations

import math
import numbers
from collections.abc import Iterable, Mapping, Sequence

from aff_runtime.base.errors import PlantError
from aff_runtime.base.suggest import hint
from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Value
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.arrays.corrections import declared_numbers
from sim_plant.line.arrays.locations import places_of
from sim_plant.line.declared.declaration import Declaration, EffectEntry


def apply_effects(
    declaration: Declaration, arrays: LineArrays, entries: Iterable[EffectEntry]
) -> LineArrays:
    """Return ``arrays`` with every entry added.

    Raises
    ------
    PlantError
        On an unknown effect, location or parameter (the message offers the nearest name), on
        a form that a place cannot have, and on a second of one kind that does not add to one that
        is there.
    """
    there: dict[tuple[str, int], list[Mapping[str, Value]]] = {}
    for number, entry in enumerate(entries):
        where = f"effects.{number}"
        effect = _known(BY_NAME, entry.effect, f"{where}.effect")
        values = merged(effect, entry.parameters, where)
        for place in places_of(declaration, effect, entry.location, f"{where}.location"):
            against = effect.refuses(arrays, place, values) if effect.refuses is not None else ""
            if against:
                raise PlantError(f"{where}: {effect.name} at {entry.location}: {against}")
            ones = there.setdefault((effect.name, place), [])
            _not_twice(effect, ones, values, f"{where}: {effect.name} at {entry.location}")
            ones.append(values)
            at = declared_numbers(declaration)[place].shift if effect.shifted_by else place
            arrays = effect.apply(arrays, at, values)
    return arrays


def _not_twice(
    effect: Effect, ones: Sequence[Mapping[str, Value]], values: Mapping[str, Value], where: str
) -> None:
    """Raise PlantError where one of these that are there already does not add to another."""
    if effect.beside is None:
        return
    for one in ones:
        against = effect.beside(one, values)
        if against:
            raise PlantError(f"{where} is there already, {against}")


def _known(table: Mapping[str, Effect], name: str, where: str) -> Effect:
    if name not in table:
        raise PlantError(
            f"{where}: read {name!r}; expected one of {sorted(table)}{hint(name, table)}"
        )
    return table[name]


def merged(effect: Effect, given: Mapping[str, Value], where: str) -> dict[str, Value]:
    """Return defaults with ``given`` on top; PlantError on an unknown key, word or number."""
    values = dict(effect.parameters)
    for key, value in given.items():
        if key not in values:
            raise PlantError(f"{where}.parameters: unknown key {key!r}{hint(key, values)}")
        if isinstance(values[key], str):
            values[key] = _word(str(value), effect.accepts[key].words, f"{where}.parameters.{key}")
        else:
            values[key] = _number(value, f"{where}.parameters.{key}")
    return values


def _word(value: str, words: Sequence[str], where: str) -> str:
    """Return a word of the catalogue's row; PlantError on another, where the row names them."""
    if words and value not in words:
        raise PlantError(
            f"{where}: read {value!r:.60}; expected {' or '.join(words)}{hint(value, words)}"
        )
    return value


def _number(value: object, where: str) -> float:
    """Return a finite number; PlantError on anything else that YAML may hold."""
    try:
        found = float(value) if isinstance(value, numbers.Real) else math.nan
    except OverflowError:  # a whole number of hundreds of digits
        found = math.inf
    if isinstance(value, bool) or not math.isfinite(found):
        raise PlantError(f"{where}: read {value!r:.60}; expected a number")
    return found
