"""Effects that are a declared number by another name: both ways, from their files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from sim_plant.base.effects import Effect
from sim_plant.effects.catalogue import CATALOGUE
from sim_plant.line.arrays.build import build_arrays, cell_sensors, timing_of
from sim_plant.line.arrays.corrections import declared_numbers
from sim_plant.line.arrays.locations import candidate_locations, places_of
from sim_plant.line.declared.declaration import Declaration
from sim_plant.refine.model.hypotheses import Hypothesis, hypothesis
from sim_plant.refine.model.nuisances import Nuisance


@dataclass(frozen=True, slots=True, kw_only=True)
class Equivalent:
    """One number of an effect that changes nothing but one declared number.

    Attributes
    ----------
    number : dotted path of the declared number.
    effect, location, parameter : what changes it.
    scale : change of the declared number, as its tolerance counts it, per unit of the parameter.
    proposed : a number pulled beyond its tolerance is tried as this effect.
    """

    number: str
    effect: Effect
    location: str
    parameter: str
    scale: float
    proposed: bool


def equivalents(line: Declaration) -> list[Equivalent]:
    """Return every number of an effect that a declared number of this line stands for."""
    arrays = build_arrays(line, timing_of(line, line.sample_time_s))
    known = {number.name for number in declared_numbers(line)}
    found = [
        Equivalent(
            number=row.number.format(place=_named(line, effect, at)),
            effect=effect,
            location=location,
            parameter=row.parameter,
            scale=row.scale(arrays, at),
            proposed=row.proposed,
        )
        for effect in CATALOGUE
        for row in effect.declared_as
        for location in candidate_locations(line, effect)
        for at in places_of(line, effect, location, effect.name)
    ]
    return [e for e in found if e.number in known]


def _named(line: Declaration, effect: Effect, at: int) -> str:
    """Return what a dotted path calls the place of this index: a roller, or a cell's channel."""
    if effect.place == "cell":
        return cell_sensors(line)[at].channel
    if effect.place == "drive":
        return line.control.drives[at].roller
    return line.rollers[at].name if effect.place == "body" else ""


def within_tolerance(
    line: Declaration, nuisances: Iterable[Nuisance], h: Hypothesis, values: Sequence[float]
) -> bool:
    """Return whether all numbers of ``h`` are changes that the declaration admits anyway.

    A strong record tells a radius to a millionth; that it is not the declared one to the last
    digit is no finding. Effects that are no declared number are never within a tolerance.
    """
    known = {n.name: n.tolerance for n in nuisances}
    change = declared_change(line, h, values)
    return bool(change) and all(
        abs(shift) <= known.get(number, 0.0) for number, shift in change.items() if shift != 0.0
    )


def declared_change(line: Declaration, h: Hypothesis, values: Sequence[float]) -> dict[str, float]:
    """Return by how much ``h`` changes declared numbers, as their tolerances count it.

    Empty where a number of it is no declared number.
    """
    rows = [e for e in equivalents(line) if e.effect is h.effect and e.location == h.location]
    change = {n: v - a for n, v, a in zip(h.names, values, h.absent, strict=True)}
    if set(change) - {e.parameter for e in rows}:
        return {}
    return {e.number: change[e.parameter] * e.scale for e in rows if e.parameter in change}


def as_effects(
    line: Declaration, number: str, shift: float
) -> list[tuple[Hypothesis, tuple[float, ...]]]:
    """Return the effects that say the same as a shift of a declared number, and their values.

    None where no effect is proposed for that number, or where it cannot go that way.
    """
    effects = []
    for e in equivalents(line):
        if e.number != number or not e.proposed:
            continue
        h = hypothesis(e.effect, e.location, line=line)
        at = h.names.index(e.parameter)
        values = [*h.absent]
        values[at] += shift / e.scale
        if h.linear[at] or values[at] > h.absent[at]:
            effects.append((h, tuple(values)))
    return effects
