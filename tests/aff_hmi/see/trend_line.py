"""A line whose curves over time are kept, second by second."""

from __future__ import annotations

from dataclasses import replace

from aff_hmi.layout import layout_of
from aff_hmi.see.series import Series
from aff_hmi.see.store import Store
from aff_hmi.see.trend_rows import HOUR_S, BinnedCurves
from aff_hmi.see.trends import Curves, Trends
from aff_hmi.watch import News
from aff_hmi.words import say_in
from tests.aff_hmi.moments import facts, row, seen

SAY = say_in("en")
T0_S = 1.8e9 // HOUR_S * HOUR_S  # an hour begins
COLUMNS = tuple(row())
LAYOUT = layout_of(facts(), ("unwind_tension_N", "tension_ref_N", "line_speed_m_s"))


class Line:
    """A line whose wall clock is turned by hand; ten ticks a second are enough here."""

    def __init__(self, store: Store, at_s: float = T0_S) -> None:
        self.at_s = at_s
        self.store = store
        self.trends = Trends(store, lambda: self.at_s)
        self.trends.look(seen(), LAYOUT, COLUMNS)

    def second(self, *tensions: float, **more: float) -> None:
        """Play one second in which these tensions were measured."""
        moment = row(**more)
        records = [tuple((moment | {"unwind_tension_N": t}).values()) for t in tensions]
        if records:
            self.trends.listen(News(columns=COLUMNS, records=records))
            self.trends.look(seen(moment), LAYOUT, COLUMNS)
        self.at_s += 1.0
        self.trends.look(replace(seen(), writer_lives=False), LAYOUT, COLUMNS)

    def jump(self, by_s: float) -> None:
        self.at_s += by_s
        self.store.now(lambda c: None)  # the disk keeps up
        self.trends.look(replace(seen(), writer_lives=False), LAYOUT, COLUMNS)

    def of(self, group: str, window: str) -> Curves:
        return self.store.now(self.trends.wanted(group, window))

    def tension(self, window: str) -> BinnedCurves:
        found = self.of("tension", window)
        at = found.series.index(Series("tension", "unwind tension", "value", "N"))
        return BinnedCurves(found.binned.t_s, found.binned.bins[:, :, at], found.binned.bin_s)
