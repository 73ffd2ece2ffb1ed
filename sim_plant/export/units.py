"""Units of an FMU: exponents of the SI base units, and in what an importer shows them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """Exponents by name of the base unit; ``shown``: another name, and how many per unit."""

    exponents: Mapping[str, int] = field(default_factory=dict)
    shown: tuple[str, float] | None = None


UNITS: dict[str, Unit] = {
    "1": Unit(),
    "s": Unit(exponents={"s": 1}),
    "m": Unit(exponents={"m": 1}, shown=("mm", 1e3)),
    "m/s": Unit(exponents={"m": 1, "s": -1}, shown=("m/min", 60.0)),
    "rad": Unit(exponents={"rad": 1}, shown=("deg", 180.0 / math.pi)),
    "rad/s": Unit(exponents={"rad": 1, "s": -1}, shown=("rpm", 30.0 / math.pi)),
    "Hz": Unit(exponents={"s": -1}),
    "N": Unit(exponents={"kg": 1, "m": 1, "s": -2}),
    "N.m": Unit(exponents={"kg": 1, "m": 2, "s": -2}),
    "N.m.s": Unit(exponents={"kg": 1, "m": 2, "s": -1}),
    "kg.m2": Unit(exponents={"kg": 1, "m": 2}),
    "kg/m3": Unit(exponents={"kg": 1, "m": -3}),
    "kg": Unit(exponents={"kg": 1}),
    "N.s/m": Unit(exponents={"kg": 1, "s": -1}),
    "1/K": Unit(exponents={"K": -1}),
    "m/(s.N)": Unit(exponents={"kg": -1, "s": 1}),
}
