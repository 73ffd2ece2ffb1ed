"""Where orders of two rolls have one frequency: there their blocks add up and must share.

As in a site file, ``rolls`` are rolls or rollers: a roller is one of fixed radius.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

from aff_runtime.config.models import Actuator, Site

SAME_RATIO = 0.01
"""Orders of two rollers whose frequencies differ by a smaller share meet at every speed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Meeting:
    """``order`` of ``roll`` meets ``other_order`` of ``other_roll``; n / R is then the same.

    ``radius_m`` is the crossing: the radius of ``roll`` at which they meet. Where both are rollers
    they meet ``always``, or all but: their frequencies are within ``SAME_RATIO``.
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
    """Return the frequency of an order at a web speed: n v / (2 pi R)  [source 5.9]."""
    return order * speed_m_s / (2.0 * math.pi * radius_m)


def meetings_of(site: Site, actuator: Actuator) -> tuple[Meeting, ...]:
    """Return every meeting of enabled orders of different rolls or rollers on one actuator.

    Two rolls that both change their radius have no fixed crossing and are left out.
    """
    orders = [
        (block.roll, order)
        for block in actuator.blocks
        if block.enabled and block.roll in site.rolls
        for order in block.orders
    ]
    found = []
    for one, other in combinations(orders, 2):
        meeting = _meeting(site, one, other)
        if meeting is not None:
            found.append(meeting)
    return tuple(sorted(found, key=lambda meeting: -meeting.radius_m))


def _meeting(site: Site, one: tuple[str, int], other: tuple[str, int]) -> Meeting | None:
    """Return where an order of one roll meets that of another, each as (name, order).

    None where they are of one roll, where neither has a fixed radius, or where the crossing is
    beyond the radii that the other can have.
    """
    if one[0] == other[0]:
        return None
    # the second has the fixed radius, so that the crossing is a radius of the first
    if site.rolls[one[0]].radius_m is not None and site.rolls[other[0]].radius_m is None:
        one, other = other, one
    (name, n), (other_name, m) = one, other
    fixed_m = site.rolls[other_name].radius_m
    if fixed_m is None:
        return None
    crossing_m = n * fixed_m / m
    roll = site.rolls[name]
    always = roll.radius_m is not None
    slack = SAME_RATIO if always else 0.0
    if not (
        roll.smallest_radius_m * (1 - slack) <= crossing_m <= roll.largest_radius_m * (1 + slack)
    ):
        return None
    return Meeting(
        roll=name,
        order=n,
        other_roll=other_name,
        other_order=m,
        radius_m=crossing_m,
        always=always,
    )
