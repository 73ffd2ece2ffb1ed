"""Rolls of web that ran, by the PLC's number of each: how far from round each one is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from aff_runtime.app.report.parquet import Columns
from aff_runtime.app.report.watching.findings import QUANTITIES, Quantity
from aff_runtime.app.report.watching.store import Store
from aff_runtime.app.report.watching.trend import at_least_small

LEFT = Quantity(
    name="ripple_N", error="ripple_error_N", unit="N", word="ripple that is left", correcting=True
)
RANKED = tuple(one for one in QUANTITIES if one.of_roller)
"""What rolls may be ranked by: what most of them have; at a tie the earlier, the shape first."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderSize:
    """An order of a roll in one quantity, such as its largest, with its standard error, SI."""

    order: int
    size: float
    error: float


@dataclass(frozen=True, slots=True, kw_only=True)
class WoundRoll:
    """One roll of web.

    Attributes
    ----------
    roll : name of its place. ``roll_id`` : the PLC's number of it.
    first, last : UTC of the first and last reading of it. ``hours`` : of runs with a reading.
    sizes : by name of a quantity of ``RANKED``, each order's largest in any tension; ``worst`` :
        the largest of them. ``left`` : ripple while it was corrected.
    turns : of the reading with the most; of fewer than ``FEWEST_TURNS`` no size is told.
    supplier : number of its supplier, the one that the PLC gave of it in the most hours; 0 where
        it gave none.
    """

    roll: str
    roll_id: int
    first: np.datetime64
    last: np.datetime64
    hours: int
    sizes: dict[str, tuple[OrderSize, ...]]
    left: OrderSize | None
    turns: int = 0
    supplier: int = 0

    @property
    def worst(self) -> dict[str, OrderSize]:
        """Return the largest order in each quantity that it has."""
        return {
            name: max(sizes, key=lambda one: one.size)
            for name, sizes in self.sizes.items()
            if sizes
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class Ranking:
    """Rolls of one place, the farthest from round first.

    Attributes
    ----------
    by : quantity that they are ranked by; None where no order of any was read.
    """

    roll: str
    by: Quantity | None
    rolls: tuple[WoundRoll, ...]


def rankings(store: Store) -> list[Ranking]:
    """Return the rolls of each place; those come last of which the quantity is not known."""
    orders = store.orders
    places = sorted(set(orders["roll"][orders["is_roll"]]))
    return [_ranking(orders, place) for place in places]


def _ranking(orders: Columns, place: str) -> Ranking:
    mine = orders["is_roll"] & (orders["roll"] == place)
    rolls = [
        _wound(orders, mine & (orders["roll_id"] == number), place, int(number))
        for number in sorted(set(orders["roll_id"][mine].tolist()))
    ]
    known = [(sum(q.name in one.worst for one in rolls), q) for q in RANKED]
    most = max(count for count, _ in known)
    by = next((q for count, q in known if count == most), None) if most else None
    return Ranking(roll=place, by=by, rolls=tuple(sorted(rolls, key=_worst_first(by))))


def _worst_first(by: Quantity | None) -> Callable[[WoundRoll], tuple[float, int]]:
    def key(one: WoundRoll) -> tuple[float, int]:
        worst = one.worst.get(by.name) if by is not None else None
        return (-worst.size if worst is not None else np.inf, one.roll_id)

    return key


def _wound(orders: Columns, rows: np.ndarray, place: str, number: int) -> WoundRoll:
    part = {name: values[rows] for name, values in orders.items()}
    times = part["time_utc"]
    hours = set(zip(part["run_id"], part["hour"].tolist(), strict=True))
    return WoundRoll(
        roll=place,
        roll_id=number,
        first=times.min(),
        last=times.max(),
        hours=len(hours),
        sizes={q.name: _sizes(part, q) for q in RANKED},
        left=max(_sizes(part, LEFT), key=lambda one: one.size, default=None),
        turns=int(part["turns"].max()),
        supplier=_supplier(part),
    )


def _supplier(part: Columns) -> int:
    """Return the number that was given in the most hours; of two the later one, 0 for none.

    A number that stands for less is a word that came late, or was wrong meanwhile.
    """
    given = part["supplier"] > 0
    numbers = part["supplier"][given].tolist()
    hours: dict[int, set[tuple[str, int]]] = {}
    for number, run, hour in zip(
        numbers, part["run_id"][given], part["hour"][given].tolist(), strict=True
    ):
        hours.setdefault(int(number), set()).add((run, hour))
    last = {int(number): at for at, number in enumerate(numbers)}
    return max(last, key=lambda number: (len(hours[number]), last[number]), default=0)


def _sizes(part: Columns, quantity: Quantity) -> tuple[OrderSize, ...]:
    """Return the mean of each order's readings, of the tension in which that is the largest."""
    known = np.isfinite(part[quantity.name]) & np.isfinite(part[quantity.error])
    if quantity.correcting is not None:
        known &= part["correcting"] == quantity.correcting
    keys = set(zip(part["signal"][known], part["order"][known].tolist(), strict=True))
    means: dict[int, OrderSize] = {}
    for signal, order in sorted(keys):
        ours = known & (part["signal"] == signal) & (part["order"] == order)
        size, error = part[quantity.name][ours], part[quantity.error][ours]
        weight = 1.0 / at_least_small(error, size) ** 2
        mean = float(np.average(size, weights=weight))
        if order not in means or mean > means[order].size:
            error_of_mean = float(weight.sum()) ** -0.5
            means[order] = OrderSize(order=order, size=mean, error=error_of_mean)
    return tuple(means[order] for order in sorted(means))
