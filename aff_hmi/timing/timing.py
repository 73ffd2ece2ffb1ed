"""Behind the page of timing and rights: every tick counted, how machine and screen stand."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from aff_hmi.counts import Counts
from aff_hmi.hand import Hand
from aff_hmi.layout import Layout
from aff_hmi.see.store import Store
from aff_hmi.timing.histogram import EDGES_US, Figures, Times
from aff_hmi.timing.rights import RightLine, right_lines
from aff_hmi.timing.usage import ServerUsage, server_usage
from aff_hmi.timing.who import WhoLine, who_lines
from aff_hmi.waiting import Waiting
from aff_hmi.watch import News, Observed
from aff_hmi.words import N_, Say
from aff_runtime.app.report.metrics.readings import MetricHistogram
from aff_runtime.base.machine import Machine, machine
from aff_runtime.base.ports import Clock
from aff_runtime.base.printable import printable

MACHINE_NS = 10_000_000_000
# column of the record: what it is called, and its factor to us
COLUMNS = {
    "wake_us": (N_("wake-up: how late a tick begins"), 1.0),
    "io_us": (N_("exchange with the PLC"), 1.0),
    "tick_us": (N_("whole tick"), 1.0),
    "age_s": (N_("age of the PLC's data"), 1e6),
}
METRICS = {
    "wake_us": "aff_tick_wakeup_delay_seconds",
    "io_us": "aff_tick_wire_duration_seconds",
    "tick_us": "aff_tick_duration_seconds",
    "age_s": "aff_plc_data_age_seconds",
}
TOLD = slice(7, 38, 3)  # of the classes: from 50 us to 50 ms, each twice the one before


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeLine:
    """One quantity: percentiles of a minute and of all, us, and how many ticks a class has."""

    name: str
    minute: Figures
    whole: Figures
    counts: tuple[int, ...]
    counts_minute: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class TimingPart:
    """What changes on the page; None where it is not known.

    Attributes
    ----------
    late : ticks longer than the cycle. ``missed`` : that did not happen, since the service began.
    unread : ticks that this screen did not see. ``edges_us`` : upper edges of the classes.
    rows, rows_lost : of the recorder. ``history`` : what is wrong with the screen's history.
    facts_age_s : since the supervisor spoke.
    """

    cycle_ms: float | None
    hold_ms: float | None
    fault_ms: float | None
    ticks: int
    late: int
    missed: int | None
    unread: int
    facts_age_s: float | None
    rows: int | None
    rows_lost: int | None
    times: tuple[TimeLine, ...]
    edges_us: tuple[float, ...]
    rights: tuple[RightLine, ...]
    kernel: str
    machine: Machine
    own: ServerUsage
    sockets: int
    frames: int
    skipped: int
    history: str
    who: tuple[WhoLine, ...]


class Timing:
    """Counts every tick that arrives.

    Parameters
    ----------
    counts : what the screen counts of itself. ``hand`` : None on a screen for looking only.
    """

    def __init__(self, clock: Clock, counts: Counts, hand: Hand | None, store: Store) -> None:
        self._clock = clock
        self._counts = counts
        self._hand = hand
        self._store = store
        self._times = {name: Times() for name in COLUMNS}
        self._cycle_s = math.inf
        self._late = self._ticks = 0
        self._machine = machine()
        self._machine_ns = clock.now_ns()
        self._seen = Observed()
        self._waiting = Waiting()

    def listen(self, news: News) -> None:
        """Take the ticks of a poll; they are counted when somebody asks, or when they are many."""
        self._waiting.add(news)
        if self._waiting.is_much:
            self._count()

    def _count(self) -> None:
        for news in self._waiting.take():
            if len(news.records):
                self._count_all(news)

    def _count_all(self, news: News) -> None:
        second = self._clock.now_ns() // 1_000_000_000
        rows = np.asarray(news.records)
        self._ticks += len(rows)
        for name, (_, factor) in COLUMNS.items():
            if name in news.columns:
                at = news.columns.index(name)
                values = factor * rows[:, at]
                self._times[name].add(values, second)
                if name == "tick_us":
                    self._late += int((values > 1e6 * self._cycle_s).sum())

    def look(self, seen: Observed, layout: Layout) -> None:
        """Take note of a moment."""
        self._seen = seen
        site = seen.site
        self._cycle_s = site.cycle_s if site is not None else math.inf
        now_ns = self._clock.now_ns()
        if now_ns - self._machine_ns >= MACHINE_NS:
            self._machine, self._machine_ns = machine(), now_ns

    def part(self, say: Say) -> TimingPart:
        """Return what the page shows of the newest moment."""
        self._count()
        seen = self._seen
        facts = seen.facts
        site = seen.site
        recorder = facts.status.recorder if facts is not None else None
        missed = seen.row.number("missed_count") if seen.row is not None else math.nan
        second = self._clock.now_ns() // 1_000_000_000
        return TimingPart(
            cycle_ms=1e3 * site.cycle_s if site is not None else None,
            hold_ms=1e3 * site.hold_after_s if site is not None else None,
            fault_ms=1e3 * site.fault_after_s if site is not None else None,
            ticks=self._ticks,
            late=self._late,
            missed=int(missed) if math.isfinite(missed) else None,
            unread=seen.unread,
            facts_age_s=round(seen.facts_age_s, 1) if seen.facts_age_s is not None else None,
            rows=recorder.rows if recorder is not None else None,
            rows_lost=recorder.lost if recorder is not None else None,
            times=tuple(self._line(name, second, say) for name in COLUMNS),
            edges_us=tuple(float(f"{edge:.4g}") for edge in EDGES_US),
            rights=right_lines(seen.meta.rights if seen.meta is not None else (), say),
            kernel=printable(seen.meta.machine, 120) if seen.meta is not None else "",
            machine=self._machine,
            own=server_usage(),
            sockets=self._counts.sockets,
            frames=self._counts.sent,
            skipped=self._counts.skipped,
            history=printable(self._store.trouble, 120),
            who=who_lines(self._hand, say),
        )

    def histograms(self) -> Iterator[MetricHistogram]:
        """Yield the times of every tick that was seen as histograms of a monitoring system."""
        self._count()
        for name, metric in METRICS.items():
            whole = self._times[name].whole
            below = np.cumsum(whole.counts)
            edges = [float(f"{1e-6 * edge:.3g}") for edge in EDGES_US[TOLD]]
            counts = [float(count) for count in below[:-1][TOLD]]
            yield MetricHistogram(
                metric,
                (*zip(edges, counts, strict=True), (math.inf, float(below[-1]))),
                1e-6 * whole.total_us,
            )

    def _line(self, name: str, second: int, say: Say) -> TimeLine:
        times = self._times[name]
        minute = times.minute(second)
        return TimeLine(
            name=say(COLUMNS[name][0]),
            minute=minute.figures(),
            whole=times.whole.figures(),
            counts=tuple(int(n) for n in times.whole.counts),
            counts_minute=tuple(int(n) for n in minute.counts),
        )
