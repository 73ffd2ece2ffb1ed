"""Where orders of different rolls meet as a radius shrinks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from aff_runtime.core.params import RollParams


@dataclass(frozen=True, slots=True, kw_only=True)
class Crossing:
    """Two orders of different rolls share a frequency at ``radius_m`` of the first."""

    roll: str
    order: int
    other_roll: str
    other_order: int
    radius_m: float


def crossings(
    rolls: Sequence[RollParams], orders: Mapping[str, Sequence[int]]
) -> tuple[Crossing, ...]:
    """Return every meeting of a shrinking roll with one of fixed radius, largest radius first.

    At line speed v an order n of radius R turns at n v / (2 pi R), (5.9); n / R = m / R_other
    does not depend on speed. ``orders`` lists the enabled orders per roll name. Two rolls that
    both change their radius have no fixed meeting and are left to the gain sharing.
    """
    moving = [roll for roll in rolls if roll.radius is not None]
    fixed = [roll for roll in rolls if roll.radius is None and roll.radius_m]
    found = [
        Crossing(roll=a.name, order=n, other_roll=b.name, other_order=m, radius_m=radius_m)
        for a in moving
        for b in fixed
        for n in sorted(set(orders.get(a.name, ())))
        for m in sorted(set(orders.get(b.name, ())))
        if a.radius_min_m <= (radius_m := n * (b.radius_m or 0.0) / m) <= a.radius_max_m
    ]
    return tuple(sorted(found, key=lambda crossing: -crossing.radius_m))
