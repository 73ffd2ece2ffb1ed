"""How far the numbers of a right single effect are off those that were hidden.

Not compared: angles and moments (a share of them depends on where one counts from), an order, for
it says which and not how much, and what the verdict says no record shows.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any


@dataclass(frozen=True, slots=True, kw_only=True)
class Declared:
    """What the line's file says of numbers that an effect changes; nan: not known.

    ``wound_strain``: with which the roll is wound. ``cell_Hz``: corner of the load cells.
    """

    wound_strain: float = math.nan
    cell_Hz: float = math.nan


Told = Callable[[float, Declared], float]
"""From a number of the library to the one that the label has."""


def declared_in(line: Mapping[str, Any]) -> Declared:
    """Return those numbers of a line's file."""
    web = line["web"]
    corners = [row["low_pass_Hz"] for row in line["sensors"] if "low_pass_Hz" in row]
    return Declared(wound_strain=web["wound_in_tension_N"] / web["EA_N"], cell_Hz=corners[0])


def _same(value: float, line: Declared) -> float:
    return value


def _inverse(value: float, line: Declared) -> float:
    return 1.0 / value


def _corner_Hz(lag_s: float, line: Declared) -> float:
    """Return the corner of a cell with this lag on top of its own: 1 / (2 pi T)."""
    return 1.0 / (2.0 * math.pi * lag_s + 1.0 / line.cell_Hz)


def _more_than_one(ratio: float, line: Declared) -> float:
    return ratio - 1.0


def _wound_share(strain: float, line: Declared) -> float:
    return 1.0 + strain / line.wound_strain


NAMES: Mapping[str, Mapping[str, tuple[str, Told]]] = MappingProxyType(
    {
        "bearing_drag": {"added_torque_N_m": ("constant_N_m", _same)},
        "load_cell_filter": {"corner_Hz": ("lag_s", _corner_Hz)},
        "load_cell_resonance": {"damping_ratio": ("damping", _same)},
        "radius_error": {"relative": ("ratio", _more_than_one)},
        "rate_limit": {"limit_m_s2": ("slew_m_s2", _same)},
        "shaft_compliance_backlash": {
            "stiffness_N_m_rad": ("compliance_rad_N_m", _inverse),
            "gap_rad": ("backlash_rad", _same),
        },
        "slip": {"creep_per_m_s": ("slope_s_m", _same), "above_m_s": ("threshold_m_s", _same)},
        "splice": {"length_m": ("piece_m", _same)},
        "unbalanced_roller": {"imbalance_kg_m": ("unbalance_kg_m", _same)},
        "viscoelastic_web": {
            "branch_fraction": ("ratio", _same),
            "relaxation_s": ("time_s", _same),
        },
        "wound_in_strain": {"factor": ("strain", _wound_share)},
    }
)
"""By effect and by the label's name: the library's name, where it is another."""
BY_LINE = frozenset({"load_cell_filter", "wound_in_strain"})
"""Effects whose hidden number is a whole one, while the library has what it is more than the
declared."""
NOT_COMPARED = frozenset({"order"})
SHAPE = "shape"
"""A profile's size is of its shape: compared where that is the same."""


def hidden_numbers(effect: Mapping[str, Any]) -> dict[str, float]:
    """Return the numbers of an effect of ``labels.yaml`` that can be compared."""
    return {
        name: float(value)
        for name, value in effect.get("parameters", {}).items()
        if isinstance(value, int | float) and value and name not in NOT_COMPARED
    }


def errors(
    effect: Mapping[str, Any], verdict: Mapping[str, Any], line: Declared
) -> dict[str, float]:
    """Return by how much, in %, found numbers are off the hidden ones, by the label's names.

    ``effect`` is one of ``labels.yaml``; empty where the verdict names another.
    """
    name = effect["effect_class"]
    rows = [row for row in verdict.get("effects", ()) if row["effect"] == name]
    if len(rows) != 1:
        return {}
    found, hidden = rows[0]["parameters"], hidden_numbers(effect)
    if SHAPE in found and found[SHAPE] != effect["parameters"].get(SHAPE):
        return {}
    told: dict[str, float] = {}
    for known in hidden:
        own, said = NAMES.get(name, {}).get(known, (known, _same))
        if found.get(own, 0.0):  # 0: no record shows it
            told[known] = said(found[own], line)
    return {known: 100.0 * abs(value / hidden[known] - 1.0) for known, value in told.items()}
