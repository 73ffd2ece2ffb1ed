"""Where orders of two rolls have one frequency: there their blocks add up and must share."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

from aff_runtime.config.models import Actuator, Site

SAME_RATIO = 0.01


@dataclass(frozen=True, slots=True, kw_only=True)
class Crossing:
    """``order`` of ``roll`` meets ``other_order`` of ``other_roll``; n / R is then the same.

    ``radius_m`` is the radius of ``roll`` at which they meet; when both rolls have fixed radii
    they meet ``always``.
    """

    roll: str
    order: int
    other_roll: str
    other_order: int
    radius_m: float
    always: bool

    def __str__(self) -> str:
        """Return one line for the technician."""
        meet = f"{self.roll} {self.order}x meets {self.other_roll} {self.other_order}x"
        return f"{meet} {'always' if self.always else f'at radius {self.radius_m:.4f} m'}"


def frequency_Hz(order: int, speed_m_s: float, radius_m: float) -> float:
    """Return the frequency of an order at a web speed: n v / (2 pi R), (5.9)."""
    return order * speed_m_s / (2.0 * math.pi * radius_m)


def crossings_of(site: Site, actuator: Actuator) -> tuple[Crossing, ...]:
    """Return every meeting of enabled orders of different rolls on one actuator.

    Two rolls that both change their radius have no fixed meeting and are left out.
    """
    orders = [
        (block.roll, order)
        for block in actuator.blocks
        if block.enabled and block.roll in site.rolls
        for order in block.orders
    ]
    found = []
    for one, other in combinations(orders, 2):
        crossing = _crossing(site, one, other)
        if crossing is not None:
            found.append(crossing)
    return tuple(sorted(found, key=lambda crossing: -crossing.radius_m))


def _crossing(site: Site, one: tuple[str, int], other: tuple[str, int]) -> Crossing | None:
    if one[0] == other[0]:
        return None
    if site.rolls[one[0]].radius_m is not None and site.rolls[other[0]].radius_m is None:
        one, other = other, one
    (name, n), (other_name, m) = one, other
    fixed_m = site.rolls[other_name].radius_m
    if fixed_m is None:
        return None
    meeting_m = n * fixed_m / m
    moving = site.rolls[name]
    always = moving.radius_m is not None
    slack = SAME_RATIO if always else 0.0
    if not (
        moving.smallest_radius_m * (1 - slack)
        <= meeting_m
        <= moving.largest_radius_m * (1 + slack)
    ):
        return None
    return Crossing(
        roll=name, order=n, other_roll=other_name, other_order=m, radius_m=meeting_m, always=always
    )
