"""Every declared number is known to a tolerance only: each is a nuisance to be projected out."""

from __future__ import annotations

import fnmatch
from dataclasses import dataclass

from sim_plant.line.arrays.corrections import declared_numbers
from sim_plant.line.declared.declaration import Declaration
from sim_plant.refine.criteria.criteria import CRITERIA


@dataclass(frozen=True, slots=True, kw_only=True)
class Nuisance:
    """One declared number with its tolerance.

    Attributes
    ----------
    name : dotted path in the declaration.
    tolerance : two standard deviations, in units of its correction (mostly relative).
    is_free : it is surely not within its tolerance, which then does not count.
    """

    name: str
    tolerance: float
    is_free: bool = False


def declared_nuisances(line: Declaration) -> list[Nuisance]:
    """Return one nuisance per declared number with a tolerance above 0."""
    rows = [(n.name, tolerance_of(line, n.name, n.kind)) for n in declared_numbers(line)]
    return [Nuisance(name=name, tolerance=known) for name, known in rows if known > 0.0]


def tolerance_of(line: Declaration, name: str, kind: str) -> float:
    """Return the declared tolerance of a path (wildcards allowed), or the default of its kind."""
    if name in line.tolerances:
        return line.tolerances[name]
    for pattern, value in line.tolerances.items():
        if fnmatch.fnmatchcase(name, pattern):
            return value
    return CRITERIA.model.default_tolerance[kind]


def effective_radius_of(roller: str) -> str:
    """Return the name under which a roller's effective radius is a nuisance."""
    return f"rollers.{roller}.effective_radius"


def is_effective_radius(number: str) -> bool:
    """Return whether a declared number of this name is a roller's effective radius."""
    return number.endswith(".effective_radius")
