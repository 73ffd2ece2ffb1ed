"""What effects share that begin at a moment of the record, and may end at another."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from sim_plant.base.arrays import CHANGE, CHANGEABLE, LineArrays
from sim_plant.base.effects import Parameter, Value
from sim_plant.base.signatures import Onset

ALWAYS_S = -1.0
"""A moment before the record: what begins then is there from the start."""
FOREVER_S = 1e6
"""Longer than any record: what lasts so long does not end."""
HOLD_S, RISE_S = "hold_s", "rise_s"
"""The parameters that say how long after its beginning something ends, and how long it rises."""

FROM = Parameter(
    default=ALWAYS_S,
    unit="s",
    typical=ALWAYS_S,
    low=ALWAYS_S,
    high=FOREVER_S,
    role="shape",
    step=0.01,
    known_to="sample",  # what begins waits up to one until it is read
)
RISE = Parameter(default=0.0, unit="s", typical=0.0, low=0.0, high=1000.0, role="shape", step=0.05)
HOLD = Parameter(
    default=FOREVER_S,
    unit="s",
    typical=FOREVER_S,
    low=0.0,
    high=FOREVER_S,
    role="shape",
    step=0.05,
    known_to="sample",
)


def begins(
    *fitted: str, grid: Mapping[str, tuple[float, ...]] | None = None, **fixed: Value
) -> Onset:
    """Return the onset of an effect with the parameter ``from_s``; these are fitted with it."""
    return Onset(
        moment="from_s",
        unit="s",
        forms=(fitted,),
        fixed=tuple(fixed.items()),
        grid=tuple((grid or {}).items()),
    )


def with_change(
    arrays: LineArrays, target: int, place: int, amount: float, parameters: Mapping[str, Value]
) -> LineArrays:
    """Return arrays in which a number changes by ``amount`` from ``from_s`` of the record on.

    It rises over ``rise_s``, and ``hold_s`` after its beginning it falls as it rose. ``target``
    is one of ``base/arrays.py``.
    """
    from_s = float(parameters["from_s"])
    row = np.zeros(1, CHANGE)
    row["target"], row["place"], row["amount"] = target, place, amount
    row["from_s"], row["rise_s"] = from_s, float(parameters.get(RISE_S, 0.0))
    hold_s = float(parameters.get(HOLD_S, FOREVER_S))
    row["until_s"] = from_s + hold_s if hold_s < FOREVER_S else math.inf
    return arrays._replace(changes=np.concatenate([arrays.changes, row]))


def with_difference(
    arrays: LineArrays, moved: LineArrays, parameters: Mapping[str, Value]
) -> LineArrays:
    """Return arrays whose numbers become those of ``moved`` at ``from_s`` of the record.

    The state is carried over: nothing but numbers that the kernel reads at every step may differ
    (`changes_only_numbers`).
    """
    for target, number in enumerate(CHANGEABLE):
        table, field = number.split(".")
        more = getattr(moved, table)[field] - getattr(arrays, table)[field]
        for place in np.flatnonzero(more):
            arrays = with_change(arrays, target, int(place), float(more[place]), parameters)
    return arrays


def changes_only_numbers(arrays: LineArrays, moved: LineArrays) -> bool:
    """Return whether lines differ, and in nothing but numbers that may change during a run."""
    differ = set()
    for table in LineArrays._fields:
        mine, other = getattr(arrays, table), getattr(moved, table)
        if mine.dtype == other.dtype and mine.tobytes() == other.tobytes():
            continue  # most tables of most numbers, and a field by itself takes as long
        for field in mine.dtype.names or ("",):
            one, two = (mine[field], other[field]) if field else (mine, other)
            if not np.array_equal(one, two):
                differ.add(f"{table}.{field}")
    return bool(differ) and differ <= set(CHANGEABLE)


def begins_later(parameters: Mapping[str, Value]) -> bool:
    """Return whether the effect is absent at the start of the record."""
    return float(parameters["from_s"]) >= 0.0
