"""``/metrics``: what is seen through the door, by the names of ``aff-runtime metrics``."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from aff_hmi.watch import Observed
from aff_runtime.app.report.metrics.exposition import exposition
from aff_runtime.app.report.metrics.readings import MetricHistogram, Sample, readings
from aff_runtime.app.report.status import live_tick
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.base.ports import Clock

KEPT_NS = 500_000_000
FACTS_PATIENCE_S = 2.0  # the door tells them twice a second


class Metrics:
    """The text of the newest moment, worked out at most twice a second, whoever asks."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._text = ""
        self._made_ns: int | None = None

    def text(
        self, seen: Observed, own: Callable[[], Iterable[Sample | MetricHistogram]] = tuple
    ) -> str:
        """Return every sample that can be told now; ``own`` : of the screen itself."""
        now_ns = self._clock.now_ns()
        if self._made_ns is None or now_ns - self._made_ns >= KEPT_NS:
            samples = (*readings(answer_of(seen), now_ns), *own())
            self._text = exposition(samples, has_process=True)
            self._made_ns = now_ns
        return self._text


def answer_of(seen: Observed) -> StatusAnswer | None:
    """Return what the service would answer to ``status``; None when none is heard.

    Facts alone are no service: those of one that has gone, or hangs, are not told as its own.
    """
    if seen.facts is None or seen.facts_age_s is None or seen.facts_age_s > FACTS_PATIENCE_S:
        return None
    status = seen.facts.status
    if seen.row is None or seen.meta is None or not seen.writer_lives:
        return status
    live = replace(live_tick(seen.row), meta=seen.meta)
    return replace(status, state=seen.row.state.name, live=live)
