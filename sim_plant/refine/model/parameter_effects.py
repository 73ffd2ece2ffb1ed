"""Effects that are a declared number by another name: both ways from one table."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.build import cell_sensors
from sim_plant.line.declaration import Declaration
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
    """

    number: str
    effect: str
    location: str
    parameter: str
    scale: float


def equivalents(line: Declaration) -> list[Equivalent]:
    """Return every number of an effect that a declared number of this line stands for."""

    def row(number: str, effect: str, place: str, parameter: str, scale: float) -> Equivalent:
        return Equivalent(
            number=number, effect=effect, location=place, parameter=parameter, scale=scale
        )

    strain = line.web.wound_in_tension_N / line.web.EA_N
    found = [
        row("web.EA_N", "web_modulus", "web", "factor", 1.0),
        row("web.wound_in_tension_N", "wound_in_strain", "web", "strain", 1.0 / strain),
    ]
    for roller in line.rollers:
        where = f"rollers.{roller.name}."
        found.append(row(where + "radius_m", "radius_error", roller.name, "ratio", 1.0))
        drag = roller.friction_constant_N_m
        share = 1.0 / drag if drag > 0.0 else float("inf")
        found.append(
            row(
                where + "friction_constant_N_m", "bearing_drag", roller.name, "constant_N_m", share
            )
        )
    for sensor in cell_sensors(line):
        for place in (sensor.roller, "all"):
            for part, parameter in (("gain", "gain"), ("offset", "offset_N")):
                number = f"sensors.{sensor.channel}.{part}"
                found.append(row(number, "load_cell_calibration", place, parameter, 1.0))
    return found


def within_tolerance(
    line: Declaration, nuisances: Iterable[Nuisance], h: Hypothesis, values: Sequence[float]
) -> bool:
    """Return whether all numbers of ``h`` are changes that the declaration admits anyway.

    A strong record tells a radius to a millionth; that it is not the declared one to the last
    digit is no finding. Effects that are no declared number are never within a tolerance.
    """
    known = {n.name: n.tolerance for n in nuisances}
    rows = [e for e in equivalents(line) if (e.effect, e.location) == h.key]
    change = {n: v - a for n, v, a in zip(h.names, values, h.absent, strict=True)}
    if set(h.names) - {e.parameter for e in rows}:
        return False
    return all(
        abs(change[e.parameter] * e.scale) <= known.get(e.number, 0.0)
        for e in rows
        if change.get(e.parameter, 0.0) != 0.0
    )


def as_effect(
    line: Declaration, number: str, shift: float
) -> tuple[Hypothesis, tuple[float, ...]] | None:
    """Return the effect that says the same as a shift of a declared number, and its values.

    None where no effect is that number, or where it cannot go that way. A radius is not asked
    for: what makes a roller's radius seem wrong is mostly its shape, which the search tries.
    """
    for e in equivalents(line):
        if e.number != number or e.effect == "radius_error":
            continue
        only = (e.parameter,) if e.effect == "bearing_drag" else None
        h = hypothesis(BY_NAME[e.effect], e.location, (), only, line)
        at = h.names.index(e.parameter)
        values = [*h.absent]
        values[at] += shift / e.scale
        return (h, tuple(values)) if h.linear[at] or values[at] > h.absent[at] else None
    return None
