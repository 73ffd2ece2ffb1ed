"""Ticks whose every value is known by a formula."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from aff_hmi.scope.signals import signals_of
from aff_hmi.scope.ticks import Cut, Ticks
from aff_hmi.watch import News
from tests.aff_hmi.moments import LINE

CYCLE_S = LINE.cycle_s
UTC_S = 1.8e9
COLUMNS = (
    *("time_s", "tick", "state", "age_s", "unwind_tension_N", "line_speed_m_s"),
    *("correction_unwind_m_s", "wake_us", "io_us", "tick_us", "unwind.theta_rad"),
)
SIGNALS = signals_of(COLUMNS, LINE)


def record(tick: int, **more: float) -> tuple[float, ...]:
    """Return one record: tension is the tick's number, the rest is as the line at work."""
    values = {
        "time_s": tick * CYCLE_S,
        "tick": float(tick),
        "state": 3.0,
        "age_s": 0.004,
        "unwind_tension_N": float(tick),
        "line_speed_m_s": 1.0,
        "correction_unwind_m_s": 0.002,
        "wake_us": 20.0,
        "io_us": 400.0,
        "tick_us": 900.0,
        "unwind.theta_rad": math.fmod(0.1 * tick, 2.0 * math.pi),
    }
    return tuple((values | more)[name] for name in COLUMNS)


def news(ticks: Sequence[int], ring: str = "one", **more: float) -> News:
    """Return what a poll brings."""
    return News(ring=ring, columns=COLUMNS, records=[record(n, **more) for n in ticks])


def cut_of(count: int, tension: Callable[[int], float], **more: Callable[[int], float]) -> Cut:
    """Return ticks 0 ... count - 1 with a tension of each, and other columns likewise."""
    ticks = Ticks(lambda: UTC_S + (count - 1) * CYCLE_S)
    ticks.begin("one", COLUMNS, SIGNALS, CYCLE_S)
    found = {"unwind_tension_N": tension, **more}
    ticks.add([record(n, **{name: of(n) for name, of in found.items()}) for n in range(count)])
    return ticks.cut()
