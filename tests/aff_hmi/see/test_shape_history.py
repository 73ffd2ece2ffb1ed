"""Scatter, growth and change of rolls against shapes whose movement is known."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace

import numpy as np
import pytest

from aff_hmi.layout import Layout, layout_of
from aff_hmi.see.rolls_part import STEP_DEG, rolls_part
from aff_hmi.see.shape_history import FEWEST, TURNS, ShapeHistory
from aff_hmi.see.store import Store
from aff_hmi.see.trend_rows import SCHEMA
from aff_hmi.see.trends import Trends
from aff_hmi.watch import Observed
from aff_hmi.words import say_in
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.signals import State
from aff_runtime.telemetry.header import RunMeta
from tests.aff_hmi.moments import facts, row
from tests.aff_hmi.see.test_rolls_part import TURN, moment, order

SAY = say_in("en")
OMEGA_RAD_S = 5.0
TURN_S = math.tau / OMEGA_RAD_S
KEY = "unwind unwind"


BASE = replace(moment(), window=None)
PLAIN = {name: value for name, value in row().items() if not name.startswith("unwind.")}


def at_moment(orders: Sequence[dict[str, float]], more: dict[str, float]) -> Observed:
    """Return a moment with these orders; one like it is not built anew each time."""
    values = dict(PLAIN)
    for one in orders:
        values |= one
    return replace(BASE, row=TickRow(values | TURN | more))


class Roll:
    """A roll of three orders, seen twice a turn; its clock is its own time."""

    def __init__(self) -> None:
        self.time_s = 0.0
        self.store = Store(None, ())
        self.history = ShapeHistory(Trends(self.store, lambda: self.time_s), lambda: self.time_s)

    def turn(self, *sizes_mm: float, **more: float) -> Observed:
        orders = [order("unwind", n + 1, mm, 0.0) for n, mm in enumerate(sizes_mm)]
        found = BASE
        for _ in range(2):
            self.time_s += 0.5 * TURN_S * 1.001
            found = at_moment(orders, {"time_s": self.time_s, **more})
            self.history.look(found)
        return found


@pytest.fixture
def roll() -> Iterator[Roll]:
    found = Roll()
    yield found
    found.store.close()


def test_the_band_is_two_standard_deviations_of_the_outline_over_its_turns(roll: Roll) -> None:
    rng = np.random.default_rng(5)
    sizes = 0.5 + 0.02 * rng.standard_normal((TURNS + 15, 3))
    for size in sizes:
        found = roll.turn(*size)
    at = np.radians(np.arange(0, 360, STEP_DEG))
    cosines = np.cos(np.outer([1, 2, 3], at))
    wanted = 2.0 * (sizes[-TURNS:] @ cosines).std(axis=0, ddof=1)
    assert roll.history.scatter_mm(KEY) == pytest.approx(wanted, rel=0.06)
    part = rolls_part(found, SAY, roll.history)
    assert len(part.rolls[0].scatter_mm) == len(part.rolls[0].outline_mm)
    json.dumps(asdict(part), allow_nan=False)


def test_of_a_few_turns_or_of_a_shape_that_is_not_learned_no_band_is_told(roll: Roll) -> None:
    for n in range(FEWEST - 1):
        roll.turn(0.5 + 0.01 * (n % 2), 0.1, 0.1)
    assert roll.history.scatter_mm(KEY) == ()
    assert roll.history.scatter_mm("unwind nothing") == ()
    still = Roll()
    for _ in range(TURNS):
        still.turn(0.5, 0.1, 0.1)
    assert still.history.scatter_mm(KEY) == ()
    still.store.close()


@pytest.mark.parametrize(
    "change", [{"state": float(State.BYPASS)}, {"time_s": 0.0}], ids=["bypassed", "begun anew"]
)
def test_a_band_is_of_one_stretch_of_learning(roll: Roll, change: dict[str, float]) -> None:
    for n in range(TURNS):
        roll.turn(0.5 + 0.01 * (n % 2), 0.1, 0.1)
    assert roll.history.scatter_mm(KEY) != ()
    roll.turn(0.5, 0.1, 0.1, **change)
    assert roll.history.scatter_mm(KEY) == ()


def test_angles_of_another_start_are_not_put_beside_these(roll: Roll) -> None:
    for n in range(TURNS):
        roll.turn(0.5 + 0.01 * (n % 2), 0.1, 0.1)
    again = replace(moment(time_s=roll.time_s + 1.0), meta=RunMeta(start_ns=7))
    roll.history.look(again)
    assert roll.history.scatter_mm(KEY) == ()


def test_another_roll_is_told_with_its_number_and_since_when(roll: Roll) -> None:
    found = roll.turn(0.5, 0.1, 0.1, roll_id=40.0)
    part = rolls_part(found, SAY, roll.history)
    assert (part.roll_number, part.roll_since_s) == (None, None)
    for n in range(TURNS):
        roll.turn(0.5 + 0.01 * (n % 2), 0.1, 0.1, roll_id=40.0)
    at_s = roll.time_s + 0.5 * TURN_S * 1.001
    found = roll.turn(0.5, 0.1, 0.1, roll_id=41.0)
    assert roll.history.scatter_mm(KEY) == ()
    part = rolls_part(found, SAY, roll.history)
    assert (part.roll_number, part.roll_since_s) == (41.0, round(at_s, 1))


def moment_of(size_mm: float) -> Observed:
    return replace(BASE, row=TickRow(row() | {"unwind.unwind_1x.shape_mm": size_mm}))


def grown(sizes_mm: np.ndarray) -> bool:
    """Return whether an order whose mean of each minute was this is told as growing."""
    at_s = [1.8e9 // 3600 * 3600]
    store = Store(None, SCHEMA)
    trends = Trends(store, lambda: at_s[0])
    layout: Layout = layout_of(facts(), ("unwind_tension_N",))
    columns = tuple(row())
    for size in sizes_mm:
        for _ in range(2):
            trends.look(moment_of(float(size)), layout, columns)
            at_s[0] += 30.0
    history = ShapeHistory(trends, lambda: at_s[0])
    found = history.grows("unwind", "unwind_1x")
    assert not history.grows("unwind", "unwind_2x")  # stays at 1 mm
    store.close()
    return found


def test_an_order_that_rises_above_its_scatter_grows_and_no_other() -> None:
    rng = np.random.default_rng(1)
    minutes, noise = np.arange(40), 0.004 * rng.standard_normal(40)
    assert grown(0.5 + 0.001 * minutes + noise)  # 0.040 mm in all, ten times its scatter
    assert not grown(0.5 + 0.0002 * minutes + noise)
    assert not grown(0.5 - 0.001 * minutes + noise)
    assert not grown(0.5 * (1.0 - np.exp(-minutes / 2.0)))  # what an arm teaches
    assert not grown((0.5 + 0.01 * minutes)[:15])  # too short to say
