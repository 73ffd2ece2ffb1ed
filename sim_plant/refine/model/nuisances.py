"""Every declared number is known to a tolerance only: each is a nuisance to be projected out."""

from __future__ import annotations

import fnmatch
from dataclasses import dataclass

from sim_plant.line.corrections import declared_numbers
from sim_plant.line.declaration import Declaration

DEFAULT_TOLERANCE = {
    "web.EA_N": 0.02,
    "web.kelvin_voigt_eta_s": 0.2,
    "web.density_kg_m3": 0.01,
    "web.thickness_m": 0.005,
    "web.wound_in_tension_N": 0.01,
    "idlers.inertia_kg_m2": 0.02,
    "friction": 0.05,
    "inertia": 0.01,
    "radius": 5e-5,
    "effective_radius": 2e-4,  # felt by the web; drive and radius sensor do not follow
    "draw": 1e-5,
    "gain": 0.001,
    "offset": 0.1,
    "corner": 0.03,
    "loop": 0.005,
    "drive": 0.005,
}
"""Assumed where a declaration gives none: two standard deviations, relative (offset in N, draw a
ratio itself)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Nuisance:
    """One declared number with its tolerance.

    Attributes
    ----------
    name : dotted path in the declaration.
    tolerance : two standard deviations, in units of its correction (mostly relative).
    """

    name: str
    tolerance: float


def declared_nuisances(line: Declaration) -> list[Nuisance]:
    """Return one nuisance per declared number that the record could feel."""
    rows = [(n.name, tolerance_of(line, n.name, n.kind)) for n in declared_numbers(line)]
    return [Nuisance(name=name, tolerance=known) for name, known in rows if known > 0.0]


def tolerance_of(line: Declaration, name: str, kind: str) -> float:
    """Return the declared tolerance of a path (wildcards allowed), or the default of its kind."""
    if name in line.tolerances:
        return line.tolerances[name]
    for pattern, value in line.tolerances.items():
        if fnmatch.fnmatchcase(name, pattern):
            return value
    return DEFAULT_TOLERANCE[kind]
