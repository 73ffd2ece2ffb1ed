"""What one steady stretch says of every order of every roll."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from aff_runtime.app.report.comparison.comparing import estimates, tensions
from aff_runtime.app.report.comparison.turns import FEWEST_TURNS, Array
from aff_runtime.app.report.comparison.window import Window, number, orders_of, roll_angle
from aff_runtime.app.report.watching.learned_error import (
    block_memory_s,
    block_of,
    mean_and_error,
    shape_memory_s,
)
from aff_runtime.app.report.watching.tables import HourRow, OrderRow
from aff_runtime.base.confidence import TWO_SIDED_95
from aff_runtime.base.order_columns import OrderColumns, order_columns
from aff_runtime.base.printable import printable, text_or
from aff_runtime.base.yaml_section import Section
from aff_runtime.config.models import Actuator
from aff_runtime.core.monitor import OrderState

MOST_ROWS = 2000
"""Rows of one stretch; a site file that somebody sent may list any number of orders."""
SETTLED_SHARE = 0.5
"""Share of the later half of a stretch in which an order must be settled for its learned size to
count. Near the noise it is settled and stalled by turns."""
SHAPE_LIMIT_M: float = Actuator.model_fields["shape_limit_m"].default
LEARNED = (OrderState.CONVERGING, OrderState.SETTLED, OrderState.STALLED)


@dataclass(frozen=True, slots=True, kw_only=True)
class Learned:
    """What a law has of one order, each with its error; NaN where it has none.

    Attributes
    ----------
    shape_m : deviation of the roll. ``stroke_m`` : the correction as a length of web.
    limit_m : largest shape or stroke that the site file lets the law use.
    """

    shape_m: tuple[float, float] = (math.nan, math.nan)
    stroke_m: tuple[float, float] = (math.nan, math.nan)
    response_ratio: tuple[float, float] = (math.nan, math.nan)
    limit_m: float = math.nan


def order_rows(window: Window, hour: HourRow) -> Iterator[OrderRow]:
    """Yield what a stretch says of every order; below ``FEWEST_TURNS`` its turns alone."""
    signals = dict(tensions(window))
    rows = 0
    for name, given in window.section("rolls").items():
        roll, section = str(name), Section.of(given)
        angle = roll_angle(window, section)
        if angle is None:
            continue
        orders = orders_of(window.site, roll)
        for signal, values in signals.items():
            for order, (estimate, frequency_Hz) in estimates(
                angle, values, window, orders
            ).items():
                rows += 1
                if rows > MOST_ROWS:
                    return
                is_told = estimate.turns >= FEWEST_TURNS
                at = (roll, order)
                learned = _learned(window, signal, at, frequency_Hz) if is_told else Learned()
                yield OrderRow(
                    run_id=hour.run_id,
                    hour=hour.hour,
                    time_utc=hour.time_utc,
                    signal=printable(signal, 100),
                    roll=printable(roll, 100),
                    order=order,
                    is_roll=is_wound(section),
                    correcting=hour.correcting,
                    roll_id=_last_whole(window, "roll_id"),
                    supplier=_last_whole(window, text_or(section.get("supplier"))),
                    speed_m_s=hour.speed_m_s,
                    radius_m=float(np.mean(angle.radius_m)),
                    frequency_Hz=frequency_Hz,
                    turns=estimate.turns,
                    ripple_N=estimate.amplitude if is_told else math.nan,
                    ripple_error_N=(estimate.high - estimate.amplitude) / TWO_SIDED_95,
                    floor_N=estimate.floor,
                    noise_N=_noise(values),
                    shape_m=learned.shape_m[0],
                    shape_error_m=learned.shape_m[1],
                    stroke_m=learned.stroke_m[0],
                    stroke_error_m=learned.stroke_m[1],
                    response_ratio=learned.response_ratio[0],
                    response_ratio_error=learned.response_ratio[1],
                    limit_m=learned.limit_m,
                )


def is_wound(roll: Section) -> bool:
    """Return whether a section of ``rolls`` is of wound web, which is exchanged in operation."""
    return bool(text_or(roll.get("radius"))) or roll.get("resets_on") == "splice"


def _last_whole(window: Window, name: str) -> int:
    """Return the last number of a column, 0 where there is none; a row without one has none."""
    column = window.table.columns.get(name, np.zeros(1))
    read = column[np.isfinite(column)]
    return int(np.clip(read[-1], -(2.0**53), 2.0**53)) if read.size else 0


def _noise(values: Array) -> float:
    """Return the noise (rms) of one reading, from second differences: theirs over root 6."""
    bends = np.diff(values[np.isfinite(values)], n=2)
    return float(np.std(bends)) / math.sqrt(6.0) if bends.size else math.nan


def _learned(window: Window, signal: str, at: tuple[str, int], frequency_Hz: float) -> Learned:
    """Return what the law of the actuator that keeps ``signal`` quiet has of a roll's order."""
    for name, given in window.section("actuators").items():
        actuator = Section.of(given)
        if text_or(actuator.section("error").get("signal")) != signal:
            continue
        columns = {n: v[v.size // 2 :] for n, v in window.table.columns.items()}
        order = next((o for o in order_columns(columns) if _is(o, name, at)), None)
        if order is None or not _is_settled(columns[order.state]):
            continue
        size = columns.get(order.size)
        shape = size if order.size_unit == "mm" else None
        speed = size if order.size_unit == "m/s" else None
        omega = math.tau * max(frequency_Hz, 1e-9)
        ratio = columns.get(order.response_ratio)
        largest = _largest(actuator, at)
        seconds = float(columns["time_s"][-1] - columns["time_s"][0])
        turn_s = math.tau * at[1] / omega
        shape_s, block_s = shape_memory_s(actuator, turn_s), block_memory_s(actuator, at)
        none = (math.nan, math.nan)
        return Learned(
            shape_m=none if shape is None else mean_and_error(1e-3 * shape, seconds, shape_s),
            stroke_m=none if speed is None else mean_and_error(speed / omega, seconds, block_s),
            response_ratio=none if ratio is None else mean_and_error(ratio, seconds, shape_s),
            limit_m=largest / omega if speed is not None else _shape_limit(actuator),
        )
    return Learned()


def _is(order: OrderColumns, actuator: str, at: tuple[str, int]) -> bool:
    return order.actuator == actuator and (order.roll, order.order) == at


def _is_settled(state: Array) -> bool:
    """Return whether an order never went back to rest, and was settled for most of the time."""
    if not np.all(np.isin(state, LEARNED)):
        return False
    return bool(np.mean(state == OrderState.SETTLED) >= SETTLED_SHARE)


def _largest(actuator: Section, at: tuple[str, int]) -> float:
    """Return the largest correction of a roll's order, m/s, NaN where the file has none."""
    own = block_of(actuator, at).get("amp_limit_m_s")
    return number(actuator.get("limit_m_s") if own is None else own, "m/s")


def _shape_limit(actuator: Section) -> float:
    given = actuator.get("shape_limit_m")
    return SHAPE_LIMIT_M if given is None else number(given, "m")
