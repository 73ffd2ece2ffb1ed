"""What adds up over every tick that this screen sees, for a monitoring system."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from aff_hmi.layout import Layout
from aff_hmi.waiting import Waiting
from aff_hmi.watch import News, Observed
from aff_runtime.app.report.line_facts import VELOCITY, LineFacts, RollFacts
from aff_runtime.app.report.metrics.readings import TICK_PATIENCE_S, Sample
from aff_runtime.base.events import TABLE
from aff_runtime.base.ports import Clock
from aff_runtime.base.signals import Outcome, State

EVENTS = {event.code: event.name for event in TABLE}


class Tallies:
    """Counts since the screen was started.

    A tick stands for one cycle: what never happened, or was not seen, is in no sum.
    """

    def __init__(self, clock: Clock) -> None:
        self._heard_ns = float(clock.now_ns())
        self._site: LineFacts | None = None
        self._seen = Observed()
        self._waiting = Waiting()
        self._events: Counter[str] = Counter(dict.fromkeys(EVENTS.values(), 0))
        self._outcomes: Counter[int] = Counter()
        self._active_s = 0.0
        self._saturated_s: defaultdict[str, float] = defaultdict(float)
        self._turns: defaultdict[str, float] = defaultdict(float)
        self._web_m: defaultdict[str, float] = defaultdict(float)

    def listen(self, news: News) -> None:
        """Take what a poll has brought; it is added when somebody asks, or when it is much."""
        self._waiting.add(news)
        if self._waiting.is_much:
            self._take()

    def _take(self) -> None:
        for news in self._waiting.take():
            self._take_one(news)

    def _take_one(self, news: News) -> None:
        """Add what a ring has brought; events that it held before are none of ours."""
        new = [event for event in news.events if event[1] > self._heard_ns]
        self._events.update(EVENTS[int(code)] for _, _, code, _ in new if int(code) in EVENTS)
        self._heard_ns = max([self._heard_ns, *(event[1] for event in new)])
        if self._site is not None and len(news.records):
            rows = np.asarray(news.records, dtype=float)
            self._add(_Ticks(news.columns, rows), self._site)

    def look(self, seen: Observed, layout: Layout) -> None:
        """Take note of a moment; what came before another site was told is of the one before."""
        self._seen = seen
        if seen.site is not self._site:
            if seen.site != self._site:
                self._take()
            self._site = seen.site

    def samples(self) -> Iterator[Sample]:
        """Yield every sum, and what the last ten seconds were."""
        self._take()
        yield Sample("aff_ring_overruns_total", ("screen",), self._seen.unread)
        yield Sample("aff_active_seconds_total", (), self._active_s)
        for outcome in Outcome:
            labels = (outcome.name.lower(),)
            yield Sample("aff_wire_exchanges_total", labels, self._outcomes[outcome])
        for metric, counts in (
            ("aff_events_total", self._events),
            ("aff_correction_saturated_seconds_total", self._saturated_s),
            ("aff_roll_turns_total", self._turns),
            ("aff_web_meters_total", self._web_m),
        ):
            yield from (Sample(metric, (of,), float(count)) for of, count in counts.items())
        yield from (one for one in self._of_ten_seconds() if math.isfinite(one.value))

    def _add(self, ticks: _Ticks, site: LineFacts) -> None:
        outcomes, counts = np.unique(ticks.known("outcome"), return_counts=True)
        self._outcomes.update(dict(zip(map(int, outcomes), map(int, counts), strict=True)))
        is_active = ticks.column("state") == State.ACTIVE
        self._active_s += float(is_active.sum()) * site.cycle_s
        for output in site.outputs:
            is_less = ticks.column(f"limit_ratio_{output.column}") < 1.0
            saturated = float((is_active & is_less).sum())
            self._saturated_s[output.actuator] += saturated * site.cycle_s
        is_heard = ticks.column("age_s") <= site.fault_after_s
        for roll in site.rolls:
            omega_rad_s = np.abs(ticks.column(f"{roll.name}.omega_rad_s"))
            turned_rad = np.where(is_heard, omega_rad_s, math.nan) * site.cycle_s
            self._turns[roll.name] += _sum_of(turned_rad) / math.tau
            self._web_m[roll.name] += _sum_of(turned_rad * _radius_m(ticks, roll))

    def _of_ten_seconds(self) -> Iterator[Sample]:
        """Yield ripple and largest correction; nothing of a line that does not tick."""
        seen, site = self._seen, self._site
        window, age_s = seen.window, seen.tick_age_s
        if site is None or seen.row is None or window is None or not seen.writer_lives:
            return
        if age_s is None or age_s >= TICK_PATIENCE_S:
            return
        for output in site.outputs:
            unit = "meters_per_second" if output.unit == VELOCITY else "newton_meters"
            peak = window.peak(f"correction_{output.column}")
            yield Sample(f"aff_correction_peak_{unit}", (output.actuator,), peak)
        if seen.row.plc_age_s <= site.fault_after_s:
            for channel in seen.row.channels:
                if channel.is_of("_N") and channel.name not in site.references:
                    rms_N = window.rms(channel.name)
                    yield Sample("aff_tension_ripple_rms_newtons", (channel.name,), rms_N)


class _Ticks:
    """Rows of the ring by the names of their columns."""

    def __init__(self, columns: tuple[str, ...], rows: NDArray[np.float64]) -> None:
        self._at = _places(columns)
        self._rows = rows

    def column(self, name: str) -> NDArray[np.float64]:
        """Return a column; NaN where there is none."""
        at = self._at.get(name)
        return self._rows[:, at] if at is not None else np.full(len(self._rows), np.nan)

    def known(self, name: str) -> NDArray[np.float64]:
        """Return the finite numbers of a column."""
        column = self.column(name)
        return column[np.isfinite(column)]


@lru_cache(maxsize=4)
def _places(columns: tuple[str, ...]) -> Mapping[str, int]:
    return {name: n for n, name in enumerate(columns)}


def _sum_of(values: NDArray[np.float64]) -> float:
    """Return the sum of what is finite."""
    return float(values[np.isfinite(values)].sum())


def _radius_m(ticks: _Ticks, roll: RollFacts) -> NDArray[np.float64] | float:
    if roll.radius_channel:
        return ticks.column(roll.radius_channel)
    return math.nan if roll.radius_m is None else roll.radius_m
