"""The last ten minutes of the overview against the numbers they were made of."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import asdict

import numpy as np
import pytest

from aff_hmi.layout import layout_of
from aff_hmi.see.recent_part import BIN_S, FEWEST_S, WINDOW_S, Band, RecentPart, recent_part
from aff_hmi.see.store import Store
from aff_hmi.see.trend_rows import SCHEMA
from aff_hmi.see.trends import Trends
from aff_hmi.watch import News
from aff_runtime.app.report.tick_row import TickRow
from tests.aff_hmi.moments import facts, row, seen

T0_S = 1.8e9
COLUMNS = tuple(row())
LAYOUT = layout_of(facts(), ("unwind_tension_N", "tension_ref_N", "line_speed_m_s"))
SLOT = "tension:unwind_tension_N"


class Line:
    """A line of two ticks a second, with the ripple of its two orders."""

    def __init__(self) -> None:
        self.at_s = T0_S
        self.store = Store(None, SCHEMA)
        self.trends = Trends(self.store, lambda: self.at_s)
        self.trends.look(seen(writer_lives=False), LAYOUT, COLUMNS)

    def second(self, least: float, largest: float, ripple: float = 0.03, **more: float) -> None:
        moment = row(**more)
        records = [tuple((moment | {"unwind_tension_N": t}).values()) for t in (least, largest)]
        self.trends.listen(News(columns=COLUMNS, records=records))
        values = moment | {f"unwind.unwind_{n}x.ripple": ripple for n in (1, 2)}
        self.trends.look(seen(moment, row=TickRow(values)), LAYOUT, COLUMNS)
        self.pause(1.0)

    def pause(self, by_s: float) -> None:
        self.at_s += by_s
        self.trends.look(seen(writer_lives=False), LAYOUT, COLUMNS)

    def part(self) -> RecentPart:
        return recent_part(self.trends, LAYOUT, self.at_s)


@pytest.fixture
def line() -> Iterator[Line]:
    found = Line()
    yield found
    found.store.close()


def test_the_band_leaves_out_one_second_in_a_hundred_at_each_end(line: Line) -> None:
    rng = np.random.default_rng(3)
    lows, highs = 89.0 - rng.uniform(0, 1, 200), 91.0 + rng.uniform(0, 1, 200)
    lows[100], highs[150] = 10.0, 300.0  # one bad tick each is not usual
    for low, high in zip(lows, highs, strict=True):
        line.second(low, high)
    (band,) = line.part().bands
    assert band.slot == SLOT
    assert band.low == pytest.approx(np.percentile(lows, 1.0), rel=1e-3)
    assert band.high == pytest.approx(np.percentile(highs, 99.0), rel=1e-3)


def test_of_less_than_a_minute_no_band_is_told(line: Line) -> None:
    for _ in range(FEWEST_S - 1):
        line.second(88.0, 92.0)
    assert line.part().bands == ()
    line.second(88.0, 92.0)
    assert line.part().bands == (Band(slot=SLOT, low=88.0, high=92.0),)


def test_what_a_silent_plc_said_last_is_in_no_band_and_no_line(line: Line) -> None:
    for _ in range(FEWEST_S):
        line.second(88.0, 92.0)
    for _ in range(FEWEST_S):
        line.second(50.0, 50.0, ripple=9.0, age_s=0.5)
    (band,) = line.part().bands
    assert (band.low, band.high) == (88.0, 92.0)
    told = {one.slot: one.means for one in line.part().lines}["now:unwind"]
    assert max(mean for mean in told if mean is not None) < 1.0


def test_the_line_has_the_rms_of_the_orders_and_a_hole_where_nothing_was_known(line: Line) -> None:
    for _ in range(20):
        line.second(90.0, 90.0, ripple=0.3)
    line.pause(30.0)
    for _ in range(20):
        line.second(90.0, 90.0, ripple=0.5)
    part = line.part()
    means = {one.slot: one.means for one in part.lines}["now:unwind"]
    assert len(means) == WINDOW_S // BIN_S
    assert part.to_s == T0_S + 70
    # two orders of one amplitude: rms^2 = 2 a^2 / 2
    assert means[-7:] == (
        *(pytest.approx(0.3, rel=1e-3),) * 2,
        *(None, None, None),
        *(pytest.approx(0.5, rel=1e-3),) * 2,
    )
    assert all(mean is None for mean in means[:-7])


def test_what_is_older_than_ten_minutes_is_not_told(line: Line) -> None:
    for _ in range(FEWEST_S):
        line.second(88.0, 92.0)
    line.pause(WINDOW_S + 1.0)
    part = line.part()
    assert part.bands == ()
    assert all(mean is None for one in part.lines for mean in one.means)
    json.dumps(asdict(part), allow_nan=False)
    assert not math.isnan(part.to_s)
