"""Which columns of a record speak of one order of one roll: their names, in one place."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache

IMBALANCE = "imbalance"
STATE = "state"
RESPONSE_RATIO = "gain_of_P"
# the column of an order's size says the family of laws and its unit: all banks of blocks, the
# iterative law too, write the same columns and read as ``blocks``
SIZES: Mapping[str, tuple[str, str]] = {
    "shape_mm": ("shape", "mm"),
    "amplitude_m_s": ("blocks", "m/s"),
    "amplitude_N_m": ("blocks", "N m"),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderColumns:
    """One order of a record, and the columns that speak of it.

    Attributes
    ----------
    name : ``unwind_1x``, or ``imbalance`` (order 1 of the drive's own roll; ``roll`` is empty).
    order : harmonic of the roll; 0 where the name has none.
    law : family of laws by the column of the size: ``shape``, or ``blocks`` (the iterative too).
    size_unit : unit of ``size``.
    state, size, phase_deg, ripple_before, ripple, response_ratio, share : columns, empty for none.
    """

    actuator: str
    name: str
    roll: str
    order: int
    law: str
    size_unit: str
    state: str
    size: str
    phase_deg: str
    ripple_before: str
    ripple: str
    response_ratio: str
    share: str

    @property
    def key(self) -> str:
        """Actuator and name, as the columns begin."""
        return f"{self.actuator}.{self.name}"


def order_columns(columns: Iterable[str]) -> tuple[OrderColumns, ...]:
    """Return every order of a record that has a column ``state``, in the order of the columns."""
    return _order_columns(tuple(columns))


def is_of_an_order(column: str) -> bool:
    """Whether a column may be one of an order's."""
    return column.count(".") == 2


def is_part(column: str, *parts: str) -> bool:
    """Whether a column may be one of these parts of an order, or its state."""
    return is_of_an_order(column) and column.rpartition(".")[2] in (STATE, *parts)


@lru_cache(maxsize=8)
def _order_columns(columns: tuple[str, ...]) -> tuple[OrderColumns, ...]:
    by_order: dict[tuple[str, str], dict[str, str]] = {}
    for column in filter(is_of_an_order, columns):
        actuator, name, part = column.split(".")
        by_order.setdefault((actuator, name), {})[part] = column
    return tuple(_order(*key, parts) for key, parts in by_order.items() if STATE in parts)


def _order(actuator: str, name: str, columns: Mapping[str, str]) -> OrderColumns:
    """Return the columns of one order; ``columns`` by their last part, such as ``phase_deg``."""
    size = next((part for part in columns if part in SIZES), "")
    law, unit = SIZES.get(size, ("blocks", ""))
    roll, _, order = name.rpartition("_")
    imbalance = name == IMBALANCE
    return OrderColumns(
        actuator=actuator,
        name=name,
        roll="" if imbalance else roll,
        order=1 if imbalance else int(order[:-1]) if order[:-1].isdigit() else 0,
        law=law,
        size_unit=unit,
        state=columns[STATE],
        size=columns.get(size, ""),
        phase_deg=columns.get("phase_deg", ""),
        ripple_before=columns.get("ripple_before", ""),
        ripple=columns.get("ripple", ""),
        response_ratio=columns.get(RESPONSE_RATIO, ""),
        share=columns.get("share", ""),
    )
