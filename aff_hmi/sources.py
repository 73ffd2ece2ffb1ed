"""What the pages beside the overview take their answers from: each made once, fed every tick."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from starlette.requests import HTTPConnection
from starlette.routing import BaseRoute

from aff_hmi.counts import Counts
from aff_hmi.hand import Hand
from aff_hmi.layout import Layout
from aff_hmi.scope.scope import Scope
from aff_hmi.scope.shot import PRE_PERCENT, SECONDS
from aff_hmi.scope.trigger import EVENTS
from aff_hmi.scope.trigger import WORDS as TRIGGER_WORDS
from aff_hmi.see.data_routes import data_routes
from aff_hmi.see.kept import Kept
from aff_hmi.support.bundle import FILES
from aff_hmi.support.desk import SupportDesk
from aff_hmi.timing.tallies import Tallies
from aff_hmi.timing.timing import Timing
from aff_hmi.waiting import Waiting
from aff_hmi.watch import News, Observed
from aff_hmi.windows.desk import WindowDesk
from aff_hmi.windows.of_alarms import AlarmWindows
from aff_hmi.windows.routes import tick_routes
from aff_hmi.words import Say
from aff_runtime.app.report.metrics.readings import MetricHistogram, Sample
from aff_runtime.base.ports import Clock

TIMING = "timing"
# path of a page: its template, and what its frames carry
PAGES = {
    "/alarms": ("alarms.html", "alarms"),
    "/rolls": ("rolls.html", "rolls"),
    "/trends": ("trends.html", ""),
    "/scope": ("scope.html", ""),
    "/timing": ("timing.html", TIMING),
}


class Sources:
    """What the hub hands ticks and moments to, and the pages take their answers from.

    Parameters
    ----------
    kept : history, whose store the windows share. ``counts`` : of the screen itself.
    hand : None on a screen for looking only. ``metrics`` : returns the numbers as text.

    Attributes
    ----------
    scope, windows, timing, support : one source each. ``tallies`` : sums over every tick.
    """

    def __init__(
        self,
        kept: Kept,
        clock: Clock,
        counts: Counts,
        hand: Hand | None,
        metrics: Callable[[], str],
    ) -> None:
        self.kept = kept
        self.scope = Scope(kept.wall)
        self.windows = WindowDesk(self.scope, kept.store, kept.journal)
        self._of_alarms = AlarmWindows(kept.book, self.windows, clock)
        self.timing = Timing(clock, counts, hand, kept.store)
        self.tallies = Tallies(clock)
        self.support = SupportDesk(kept, self.timing, clock, metrics)
        self._waiting = Waiting()
        kept.join(TIMING, self.timing.part)

    seconds = SECONDS
    pre_percent = PRE_PERCENT
    trigger_events = EVENTS
    triggers = tuple((on.value, word) for on, word in TRIGGER_WORDS.items())
    support_files = tuple(FILES.items())

    def listen(self, news: News) -> None:
        """Take what a poll has brought; the history takes it with its next look."""
        self.scope.listen(news)
        self.timing.listen(news)
        self.tallies.listen(news)
        self._waiting.add(news)

    def look(self, seen: Observed, layout: Layout) -> None:
        """Take note of a moment."""
        if self.kept.is_due:
            for news in self._waiting.take():
                self.kept.listen(news)
        sources = (
            *(self.kept, self.scope, self.windows, self._of_alarms),
            *(self.timing, self.tallies, self.support),
        )
        for source in sources:
            source.look(seen, layout)

    def samples(self) -> Iterator[Sample | MetricHistogram]:
        """Yield what a monitoring system is told of every tick that was seen."""
        yield from self.timing.histograms()
        yield from self.tallies.samples()

    def routes(self, say_of: Callable[[HTTPConnection], Say]) -> list[BaseRoute]:
        """Return what is asked for by GET beside the pages; nothing is changed by it."""
        return [
            *data_routes(self.kept, say_of),
            *tick_routes(self.scope, self.windows, say_of),
            *self.support.routes(),
        ]
