"""Suppliers of rolls of web by rank: how far from round the rolls of each one are."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from aff_runtime.app.report.watching.findings import Quantity
from aff_runtime.app.report.watching.wound_rolls import OrderSize, Ranking, WoundRoll

ORDERS = (1, 2, 3)
"""A roll that sags, is oval, or lay on three bearers is far from round in these."""
OUTSIDE = 0.05
"""Chance that the interval of a median does not hold it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MedianSize:
    """The median of one order over the rolls of a supplier, SI.

    ``low``, ``high`` : its 95 % interval; NaN of fewer than six rolls. ``rolls`` : that have it.
    """

    order: int
    size: float
    low: float
    high: float
    rolls: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Supplier:
    """The rolls of one supplier at one place.

    Attributes
    ----------
    number : the PLC's. ``rolls`` : of it that ran.
    medians : of ``ORDERS`` that were read. ``worst_roll``, ``worst`` : its roll that is the
        farthest from round, and that one's largest order; None where none was read.
    """

    number: int
    rolls: int
    medians: tuple[MedianSize, ...]
    worst_roll: int | None
    worst: OrderSize | None

    @property
    def rank(self) -> float:
        """Return the largest median, SI; below 0 where none was read."""
        return max((one.size for one in self.medians), default=-1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class SupplierRanking:
    """Suppliers at one place, those first whose rolls are the farthest from round.

    Attributes
    ----------
    by : quantity that they are ranked by. ``unknown`` : rolls without a number.
    """

    roll: str
    by: Quantity
    suppliers: tuple[Supplier, ...]
    unknown: int


def supplier_rankings(rankings: Sequence[Ranking]) -> list[SupplierRanking]:
    """Return the suppliers of each place of which an order of a roll was read."""
    return [_ranking(one, one.by) for one in rankings if one.by is not None]


def _ranking(place: Ranking, by: Quantity) -> SupplierRanking:
    numbers = sorted({roll.supplier for roll in place.rolls} - {0})
    found = [
        _supplier(number, [r for r in place.rolls if r.supplier == number], by)
        for number in numbers
    ]
    return SupplierRanking(
        roll=place.roll,
        by=by,
        suppliers=tuple(sorted(found, key=lambda one: (-one.rank, one.number))),
        unknown=sum(not roll.supplier for roll in place.rolls),
    )


def _supplier(number: int, rolls: list[WoundRoll], by: Quantity) -> Supplier:
    by_order: dict[int, list[float]] = {}
    worst: tuple[int, OrderSize] | None = None
    for roll in rolls:
        for one in roll.sizes[by.name]:
            if one.order not in ORDERS:
                continue
            by_order.setdefault(one.order, []).append(one.size)
            if worst is None or one.size > worst[1].size:
                worst = roll.roll_id, one
    return Supplier(
        number=number,
        rolls=len(rolls),
        medians=tuple(median_size(n, by_order[n]) for n in sorted(by_order)),
        worst_roll=None if worst is None else worst[0],
        worst=None if worst is None else worst[1],
    )


def median_size(order: int, sizes: Sequence[float]) -> MedianSize:
    """Return the median with the interval that order statistics give, whatever is their law.

    As many of n sizes lie below the median as heads are thrown with n coins, so the k-th smallest
    and the k-th largest hold it but for twice the chance of fewer than k heads (own derivation).
    """
    ordered = np.sort(np.asarray(sizes, dtype=np.float64))
    count, below, k = ordered.size, 0.0, 0
    while k < count:
        ways = math.lgamma(count + 1) - math.lgamma(k + 1) - math.lgamma(count - k + 1)
        below += math.exp(ways - count * math.log(2.0))
        if 2.0 * below > OUTSIDE:
            break
        k += 1
    low, high = (ordered[k - 1], ordered[-k]) if k else (math.nan, math.nan)
    return MedianSize(
        order=order,
        size=float(np.median(ordered)),
        low=float(low),
        high=float(high),
        rolls=int(count),
    )
