"""One order of one roll as its law sees it: columns of the record and back, in one place.

A law keeps a table of ``Column``; names and numbers of its telemetry both come from it. Whoever
reads the record (status, top, roll page, the watch on the law) reads ``OrderStatus``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain
from typing import Generic, TypeVar

from aff_runtime.core.monitor import Trend

Owner = TypeVar("Owner")
IMBALANCE = "imbalance"
STATE = "state"
# the column of an order's size says the family of laws and its unit: all banks of blocks, the
# iterative law too, write the same columns and read as ``blocks``
SIZES: Mapping[str, tuple[str, str]] = {
    "shape_mm": ("shape", "mm"),
    "amplitude_m_s": ("blocks", "m/s"),
    "amplitude_N_m": ("blocks", "N m"),
}


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
    state: Trend | None
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
    get = record.get
    return tuple(
        place.status(*[math.nan if (value := get(at)) is None else value for at in place.columns])
        for place in _places(tuple(record))
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Place:
    """What the columns of one order say of it; ``columns`` : of ``status``, empty for none."""

    actuator: str
    name: str
    roll: str
    order: int
    law: str
    size_unit: str
    columns: tuple[str, ...]

    def status(
        self,
        state: float,
        size: float,
        phase_deg: float,
        ripple_before: float,
        ripple: float,
        response_ratio: float,
        share: float,
    ) -> OrderStatus:
        """Return the order with the numbers of one record."""
        return OrderStatus(
            actuator=self.actuator,
            name=self.name,
            roll=self.roll,
            order=self.order,
            law=self.law,
            state=_trend(state),
            size=size,
            size_unit=self.size_unit,
            phase_deg=phase_deg,
            ripple_before=ripple_before,
            ripple=ripple,
            response_ratio=response_ratio,
            share=share,
        )


@lru_cache(maxsize=8)
def _places(columns: tuple[str, ...]) -> tuple[_Place, ...]:
    """Return every order of a record's columns; rings change rarely."""
    said: dict[tuple[str, str], dict[str, str]] = {}
    for column in columns:
        parts = column.split(".")
        if len(parts) == 3:
            said.setdefault((parts[0], parts[1]), {})[parts[2]] = column
    return tuple(_place(*key, of) for key, of in said.items() if STATE in of)


def _place(actuator: str, name: str, said: Mapping[str, str]) -> _Place:
    size = next((column for column in said if column in SIZES), "")
    law, unit = SIZES.get(size, ("blocks", ""))
    roll, _, order = name.rpartition("_")
    number = int(order[:-1]) if order[:-1].isdigit() else 0
    imbalance = name == IMBALANCE
    parts = (STATE, size, "phase_deg", "ripple_before", "ripple", "gain_of_P", "share")
    return _Place(
        actuator=actuator,
        name=name,
        roll="" if imbalance else roll,
        order=1 if imbalance else number,
        law=law,
        size_unit=unit,
        columns=tuple(said.get(part, "") for part in parts),
    )


def _trend(value: float) -> Trend | None:
    """Return the state that a number stands for; None when it is none."""
    return _TRENDS.get(int(value)) if math.isfinite(value) else None


_TRENDS: Mapping[int, Trend] = {int(one): one for one in Trend}
