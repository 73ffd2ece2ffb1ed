"""Whether an effect says no more than that a declared number lies within its tolerance."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from sim_plant.line.build import cell_sensors
from sim_plant.line.declaration import Declaration
from sim_plant.refine.hypotheses import Hypothesis
from sim_plant.refine.nuisances import Nuisance


def within_tolerance(
    line: Declaration, nuisances: Iterable[Nuisance], h: Hypothesis, values: Sequence[float]
) -> bool:
    """Return whether all numbers of ``h`` are changes that the declaration admits anyway.

    A strong record tells a radius to a millionth; that it is not the declared one to the last
    digit is no finding. Effects that are no declared number are never within a tolerance.
    """
    known = {n.name: n.tolerance for n in nuisances}
    given = dict(zip(h.names, values, strict=True))
    rows = _changes(line, h, given)
    return bool(rows) and all(abs(change) <= known.get(name, 0.0) for name, change in rows)


def _changes(
    line: Declaration, h: Hypothesis, given: Mapping[str, float]
) -> list[tuple[str, float]]:
    """Return (declared number, change as its tolerance counts it) per number of ``h``."""
    where = f"rollers.{h.location}."
    if h.effect.name == "radius_error":
        return [(where + "radius_m", given["ratio"] - 1.0)]
    if h.effect.name == "web_modulus":
        return [("web.EA_N", given["factor"] - 1.0)]
    if h.effect.name == "wound_in_strain":
        declared = line.web.wound_in_tension_N / line.web.EA_N
        return [("web.wound_in_tension_N", given["strain"] / declared)]
    if h.effect.name == "bearing_drag" and set(given) == {"constant_N_m"}:
        constant = line.rollers[line.body(h.location)].friction_constant_N_m
        share = given["constant_N_m"] / constant if constant > 0.0 else float("inf")
        return [(where + "friction_constant_N_m", share)]
    if h.effect.name == "load_cell_calibration":
        cells = [s.channel for s in cell_sensors(line) if h.location in (s.roller, "all")]
        parts = [("gain", given.get("gain", 1.0) - 1.0), ("offset", given.get("offset_N", 0.0))]
        return [(f"sensors.{cell}.{part}", change) for cell in cells for part, change in parts]
    return []
