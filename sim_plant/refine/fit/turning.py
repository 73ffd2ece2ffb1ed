"""What turns together: effects whose angles are those of one body, and their periods in a turn."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.signatures import Frequency, Orders
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.effects.phasor import phasor
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.turned import turned
from sim_plant.refine.model.twin import Added

ANGLES = CRITERIA.fit.start_angles


def has_start_angle(effect: Added) -> bool:
    """Return whether an effect has an angle that another start of the rolls changes."""
    record = BY_NAME[effect.effect]
    return bool(record.quadratures) or any(
        record.accepts[name].role == "angle" for name, _ in effect.parameters
    )


def orders_of(effect: Added) -> set[float]:
    """Return the orders of the parts of an effect that are not zero, per turn of its own angle.

    A profile has several. The own angle is the body's, or of what turns at a ratio of its own to
    the body the angle of that (see `turns_with`).
    """
    record = BY_NAME[effect.effect]
    values = {**record.parameters, **dict(effect.parameters)}
    orders = set()
    for k, pair in enumerate(record.quadratures, start=1):
        if phasor(values, pair) != 0.0:
            order = 1.0 if isinstance(record.shows, Frequency) else float(k)
            orders.add(float(values[pair.order]) if pair.order else order)
    of_pairs = {pair.angle for pair in record.quadratures}
    turns = (name for name, _ in effect.parameters if record.accepts[name].role == "angle")
    if any(name not in of_pairs for name in turns):
        orders.add(1.0)
        if isinstance(record.shows, Orders) and not record.shows.rolls_on:
            orders |= set(record.shows.at(values, 1.0))
    return orders or {1.0}


def turned_effect(effect: Added, angle_rad: float) -> Added:
    """Return the effect with its body turned ``angle_rad`` further when the record begins."""
    values = turned(BY_NAME[effect.effect], dict(effect.parameters), angle_rad)
    return replace(effect, parameters=tuple(values.items()))


def turns_with(effect: Added) -> str:
    """Return what an effect's angle belongs to, by name: a body, or the effect alone.

    What repeats in time, what turns along at a ratio of its own (its orders change with the
    body's radius) and what has not come round after a turn (an order behind a gear) have an angle
    of their own, wherever they are.
    """
    shows = BY_NAME[effect.effect].shows
    values = {**BY_NAME[effect.effect].parameters, **dict(effect.parameters)}
    own = isinstance(shows, Frequency)
    if isinstance(shows, Orders):
        orders = shows.at(values, 1.0)
        own = orders != shows.at(values, 2.0) or any(order % 1.0 for order in orders)
    return f"{effect.effect} at {effect.location}" if own else effect.location


def with_turned(effects: tuple[Added, ...], body: str, angle_rad: float) -> tuple[Added, ...]:
    """Return the effects, those with an angle that ``turns_with`` this body turned."""
    return tuple(
        turned_effect(e, angle_rad) if has_start_angle(e) and turns_with(e) == body else e
        for e in effects
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Turning:
    """Effects whose angles are turned together, by what they turn with.

    Attributes
    ----------
    name : see `turns_with`.
    highest : their highest order, per turn.
    period_rad : angle over which they are searched: the turn, or the part of one, after which all
        are as they were.
    """

    name: str
    highest: float
    period_rad: float

    @classmethod
    def of(cls, name: str, effects: Sequence[Added]) -> Turning:
        """Return what turns with ``name`` among the effects.

        Equation: period 2 pi / g, g the greatest common divisor of all orders, or the only one.

        Of several that are not all whole (one effect twice at one place, behind gears) a turn is
        taken: their common period may be many turns. Over a turn each of order 1 and above goes
        through all its phases, but not each pair of them through all pairs.
        """
        own = (e for e in effects if has_start_angle(e) and turns_with(e) == name)
        orders = {order for e in own for order in orders_of(e)}
        whole = all(order % 1.0 == 0.0 for order in orders)
        common = math.gcd(*map(int, orders)) if whole else 1.0
        common = min(orders) if len(orders) == 1 else common
        return cls(name=name, highest=max(orders), period_rad=2.0 * math.pi / common)

    @property
    def angle_count(self) -> int:
        """How many angles the first grid has, over one period."""
        repeats = self.highest * self.period_rad / (2.0 * math.pi)
        return max(ANGLES.coarse_angles, math.ceil(ANGLES.angles_in_period * repeats))

    @property
    def grid(self) -> Array:
        """The angles of the first grid (angle_count,), rad."""
        count = self.angle_count
        angles: Array = np.arange(count, dtype=np.float64) * (self.period_rad / count)
        return angles

    @property
    def step_share(self) -> float:
        """Factor on a step that is set for ``slope_order``: 1 for orders up to it."""
        return min(1.0, ANGLES.slope_order / self.highest)
