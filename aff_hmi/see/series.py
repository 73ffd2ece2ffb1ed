"""Which numbers of a line are kept: every tick of what is measured, samples of the rest."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aff_hmi.layout import Layout, label_of
from aff_hmi.watch import Rows
from aff_runtime.app.report.line_facts import LineFacts
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.order_columns import order_columns
from aff_runtime.base.signals import State

MOST = 96
"""Curves that are kept of a line."""
MEASURED_GROUPS = ("tension", "speed", "radius")  # what a PLC said last is no news of these
VALUE, REFERENCE, NOW, WITHOUT, MEASURED = "value", "reference", "now", "without", "measured"
"""Roles. Of ripple: of the orders now, of the orders without correction (an estimate), and all
that moves, as measured."""
CHANGE, SIZE = "dB:", "mm:"
"""How the slots of an order's curves begin, before its key."""


@dataclass(frozen=True, slots=True, order=True)
class Series:
    """One curve: ``group`` is drawn together; ``role`` tells curves of one ``label`` apart."""

    group: str
    label: str
    role: str
    unit: str


@dataclass(frozen=True, slots=True)
class _OfTick:
    series: Series
    column: str
    factor: float
    state: State | None = None


class SeriesSet:
    """What is kept of one ring.

    Parameters
    ----------
    columns : of the ring. ``layout``, ``site`` : names, units and limits of the line.

    Attributes
    ----------
    all : every curve, those of each tick first, ``MOST`` at most.
    """

    def __init__(self, columns: Sequence[str], layout: Layout, site: LineFacts) -> None:
        ticks = [one for one in _of_ticks(layout, site) if one.column in columns][:MOST]
        self._ticks = tuple(ticks)
        self._at = [columns.index(one.column) for one in ticks]
        self._factors = np.array([one.factor for one in ticks])
        self._is_measured = np.array(
            [one.series.group in MEASURED_GROUPS for one in ticks], dtype=bool
        )
        self._age_at = columns.index("age_s") if "age_s" in columns else None
        self._fault_after_s = site.fault_after_s
        self._states = [(i, one.state) for i, one in enumerate(ticks) if one.state is not None]
        samples = dict(_of_samples(layout))
        samples |= dict(_of_orders(columns, site))
        self._samples = tuple(samples)[: MOST - len(ticks)]
        self._at_of_slot = {slot: len(ticks) + n for n, slot in enumerate(self._samples)}
        self.all = (*(one.series for one in ticks), *(samples[slot] for slot in self._samples))

    def of_ticks(self, records: Rows) -> NDArray[np.float64]:
        """Return rows (ticks, curves) in the units of the screen; NaN where only samples are.

        What is measured is NaN while the PLC is silent: what it said last is not of now.
        """
        rows = np.full((len(records), len(self.all)), np.nan)
        picked = np.asarray(records)[:, self._at]
        for at, state in self._states:
            picked[:, at] = picked[:, at] == state
        if self._age_at is not None:
            is_silent = np.asarray(records)[:, self._age_at] > self._fault_after_s
            picked[is_silent[:, None] & self._is_measured] = np.nan
        rows[:, : len(self._ticks)] = picked.reshape(len(records), -1) * self._factors
        return rows

    def of_sample(self, row: TickRow, values: Mapping[str, float]) -> NDArray[np.float64]:
        """Return one row of what is no column of its own; NaN for what every tick has.

        Parameters
        ----------
        values : of the overview, by slot (``now:unwind``); those that are no curves are left out.
        """
        sample = np.full((1, len(self.all)), np.nan)
        if row.plc_age_s > self._fault_after_s:
            return sample
        numbers = sample[0]
        for slot, value in values.items():
            if (at := self._at_of_slot.get(slot)) is not None:
                numbers[at] = value
        is_active = row.state is State.ACTIVE
        for order in row.orders():
            key = f"{order.actuator}.{order.name}"
            before, now = order.ripple_before, order.ripple
            at = self._at_of_slot.get(f"{CHANGE}{key}")
            if at is not None and is_active and before > 0.0 and now > 0.0:
                numbers[at] = 20.0 * math.log10(now / before)
            if (at := self._at_of_slot.get(f"{SIZE}{key}")) is not None:
                numbers[at] = order.size
        return sample


def _of_ticks(layout: Layout, site: LineFacts) -> Iterator[_OfTick]:
    for state in (State.ACTIVE, State.FAULT):
        yield _OfTick(Series("state", state.name, VALUE, ""), "state", 1.0, state)
    for tension in layout.tensions:
        series = Series("tension", tension.label, VALUE, "N")
        yield _OfTick(series, tension.channel, 1.0)
        if tension.reference:
            series = Series("tension", tension.label, REFERENCE, "N")
            yield _OfTick(series, tension.reference, 1.0)
    for output in site.outputs:
        factor, unit = (1e3, "mm/s") if output.unit == "m/s" else (1.0, output.unit)
        label = label_of(output.actuator)
        series = Series("correction", label, VALUE, unit)
        yield _OfTick(series, f"correction_{output.column}", factor)
        series = Series("let_out", label, VALUE, "%")
        yield _OfTick(series, f"applied_ratio_{output.column}", 100.0)
    if layout.speed:
        yield _OfTick(Series("speed", label_of(layout.speed), VALUE, "m/min"), layout.speed, 60.0)
    for roll in site.rolls:
        if roll.radius_channel:
            series = Series("radius", label_of(roll.name), VALUE, "mm")
            yield _OfTick(series, roll.radius_channel, 1e3)
    for column, label, factor in (
        ("tick_us", "tick", 1e-3),
        ("wake_us", "wake", 1e-3),
        ("age_s", "age", 1e3),
    ):
        yield _OfTick(Series("timing", label, VALUE, "ms"), column, factor)


def _of_samples(layout: Layout) -> Iterator[tuple[str, Series]]:
    """Yield what the overview tells several times a second, by its slot: role and name."""
    for output in layout.outputs:
        for role in (NOW, WITHOUT):
            series = Series("ripple", output.signal, role, output.signal_unit)
            yield f"{role}:{output.actuator}", series
    for tension in layout.tensions:
        yield f"rms:{tension.channel}", Series("ripple", tension.label, MEASURED, "N")


def _of_orders(columns: Sequence[str], site: LineFacts) -> Iterator[tuple[str, Series]]:
    """Yield change in dB and size of every order, actuator by actuator."""
    known = order_columns(columns)
    for output in site.outputs:
        label = label_of(output.actuator)
        mine = [order for order in known if order.actuator == output.actuator]
        for order in mine:
            yield f"{CHANGE}{order.key}", Series(f"dB {label}", label_of(order.name), VALUE, "dB")
        for order in (one for one in mine if one.size_unit == "mm"):
            yield f"{SIZE}{order.key}", Series(f"mm {label}", label_of(order.name), VALUE, "mm")
