"""Numbers of a declaration that no line has: of effects, corrections, tolerances and rolls.

Looked at where a file is read. A search tries numbers beyond these on its way, and what comes of
them is no line.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Iterator

from aff_runtime.base.suggest import hint
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.arrays.corrections import declared_numbers
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.line.declared.sections import Section

ALIKE_M = 1e-6
"""Two radii of one roll are told apart from here on: a hundredth of a hair."""


def numbers_findings(line: Declaration) -> list[str]:
    """Return numbers that no line has, as sentences; for a line that agrees with itself."""
    findings = [*_of_rolls(line), *_of_corrections(line), *_of_tolerances(line)]
    for number, entry in enumerate(line.effects):
        findings += _of_effect(entry, f"effects.{number}.parameters")
    return findings


def _of_effect(entry: EffectEntry, where: str) -> Iterator[str]:
    """Yield what is beyond the bounds of its row; unknown names are refused where it is put."""
    accepts = BY_NAME[entry.effect].accepts if entry.effect in BY_NAME else {}
    for key, value in entry.parameters.items():
        row = accepts.get(key)
        if row is None or isinstance(row.default, str) or isinstance(value, bool):
            continue
        if isinstance(value, int | float) and not row.low <= value <= row.high:
            unit = "" if row.unit == "1" else f" {row.unit}"
            yield f"{where}.{key}: read {value:.10g}; expected {row.low:g} to {row.high:g}{unit}"


def _of_corrections(line: Declaration) -> Iterator[str]:
    known = {number.name: number for number in declared_numbers(line)} if line.corrections else {}
    for name, value in line.corrections.items():
        number = known.get(name)
        if number is None:
            yield f"corrections.{name}: this line declares no such number{hint(name, known)}"
        elif not number.low <= value <= number.high:
            yield (
                f"corrections.{name}: read {value:.10g}; expected {number.low:g} to "
                f"{number.high:g} (what is added, mostly as a share of the number)"
            )


def _of_rolls(line: Declaration) -> Iterator[str]:
    radii = line.initial_radii_m
    for end, radius_m, roller in (
        ("unwind", radii.unwind, line.rollers[0]),
        ("rewind", radii.rewind, line.rollers[-1]),
    ):
        where = f"initial_radii_m.{end}: read {radius_m:.10g}"
        # a roll that winds up may begin with its core; one that unwinds then has nothing
        if radius_m < radii.core or (end == "unwind" and radius_m == radii.core):
            yield f"{where}; expected more than the radius of the core, {radii.core:.10g}"
        elif abs(radius_m - roller.radius_m) > ALIKE_M:
            yield (
                f"{where}, but rollers.{roller.name}.radius_m says {roller.radius_m:.10g}; "
                "correct one of them"
            )


def _of_tolerances(line: Declaration) -> Iterator[str]:
    """Yield patterns that name neither a number that a record could feel nor a key of the file."""
    if not line.tolerances:
        return
    numbers = [number.name for number in declared_numbers(line)]
    known = [*numbers, *_keys(line)]
    for pattern in line.tolerances:
        if pattern not in known and not any(fnmatch.fnmatchcase(n, pattern) for n in known):
            yield f"tolerances.{pattern}: names no number of this line{hint(pattern, known)}"


def _keys(section: Section, path: str = "") -> Iterator[str]:
    """Yield the path of every key, a part of a list under its name."""
    for key in type(section).model_fields:
        value, here = getattr(section, key), f"{path}{key}"
        yield here
        for part in value if isinstance(value, tuple) else (value,):
            if isinstance(part, Section):
                named = (getattr(part, k, "") for k in ("name", "roller", "loop", "channel"))
                name = next((f".{n}" for n in named if n), "") if part is not value else ""
                yield from _keys(part, f"{here}{name}.")
