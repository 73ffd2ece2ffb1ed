"""One order of one roll as its law sees it: columns of the record and back, in one place.

A law keeps a table of ``Column``; names and numbers of its telemetry both come from it. Whoever
reads a row (status, top, roll page, the watch on the law) reads ``OrderStatus``; whoever reads
whole columns asks ``base.order_columns`` which they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Generic, TypeVar

from aff_runtime.base.order_columns import IMBALANCE, OrderColumns, order_columns
from aff_runtime.core.monitor import OrderState

Owner = TypeVar("Owner")


@dataclass(frozen=True, slots=True)
class Column(Generic[Owner]):
    """One number per order: its name in the record, and how a law works it out for all orders."""

    name: str
    values: Callable[[Owner], Iterable[float]]


def column_names(orders: Sequence[str], columns: Sequence[Column[Owner]]) -> tuple[str, ...]:
    """Return the record's names, order by order."""
    return tuple(f"{order}.{column.name}" for order in orders for column in columns)


def column_values(owner: Owner, columns: Sequence[Column[Owner]]) -> tuple[float, ...]:
    """Return the numbers in the order of ``column_names``."""
    per_column = [column.values(owner) for column in columns]
    return tuple(chain.from_iterable(zip(*per_column, strict=True)))


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderStatus:
    """One order, NaN where its law does not say.

    Attributes
    ----------
    name : ``unwind_1x``, or ``imbalance`` (order 1 of the drive's own roll; ``roll`` is empty).
    law : family of laws by the column of the size: ``shape``, or ``blocks`` (the iterative too).
    size_unit : unit of ``size``.
    state : None when the number is no state.
    ripple_before, ripple : amplitude in the signal, in its unit.
    response_ratio : true response over the measured one. ``share`` : 0..1 of it goes out.
    """

    actuator: str
    name: str
    roll: str
    order: int
    law: str
    state: OrderState | None
    size: float
    size_unit: str
    phase_deg: float
    ripple_before: float
    ripple: float
    response_ratio: float
    share: float

    @property
    def is_imbalance(self) -> bool:
        """Whether this is a torque once per turn, and no part of the roll's outline."""
        return self.name == IMBALANCE


def order_statuses(record: Mapping[str, float | None]) -> tuple[OrderStatus, ...]:
    """Return every order of a record, in the order of its columns; None stands for NaN."""
    return tuple(_status(record, order) for order in order_columns(record))


def _status(record: Mapping[str, float | None], order: OrderColumns) -> OrderStatus:
    def at(column: str) -> float:
        value = record.get(column)
        return math.nan if value is None else value

    return OrderStatus(
        actuator=order.actuator,
        name=order.name,
        roll=order.roll,
        order=order.order,
        law=order.law,
        state=_state(at(order.state)),
        size=at(order.size),
        size_unit=order.size_unit,
        phase_deg=at(order.phase_deg),
        ripple_before=at(order.ripple_before),
        ripple=at(order.ripple),
        response_ratio=at(order.response_ratio),
        share=at(order.share),
    )


def _state(value: float) -> OrderState | None:
    """Return the state that a number stands for; None when it is none."""
    return _STATES.get(int(value)) if math.isfinite(value) else None


_STATES: Mapping[int, OrderState] = {int(one): one for one in OrderState}
