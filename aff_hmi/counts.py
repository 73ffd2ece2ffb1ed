"""What the screen counts of itself; no account, address or word of a person is a label."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import accumulate

from aff_runtime.app.report.metrics.readings import MetricHistogram, Sample

LOGINS = ("done", "refused", "waits")
RESULTS = ("done", "refused", "failed")
DELAY_S = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
ANSWER_S = (0.001, 0.005, 0.02, 0.1, 0.5, 2.0)


class Durations:
    """Times in classes, s, by their upper edges."""

    def __init__(self, metric: str, edges_s: Sequence[float]) -> None:
        self._metric = metric
        self._edges_s = (*edges_s, math.inf)
        self._counts = [0] * len(self._edges_s)
        self._total_s = 0.0

    def add(self, time_s: float) -> None:
        """Count a time."""
        self._counts[bisect_left(self._edges_s, time_s)] += 1
        self._total_s += time_s

    def histogram(self) -> MetricHistogram:
        """Return them as a histogram."""
        below = map(float, accumulate(self._counts))
        return MetricHistogram(
            self._metric, tuple(zip(self._edges_s, below, strict=True)), self._total_s
        )


class Counts:
    """Since the screen was started.

    Attributes
    ----------
    sockets : browsers that look on now.
    sent, skipped : frames, and those that a slow browser did without.
    logins : by result. ``presses`` : by action and result.
    delays : from a tick to the socket. ``answers`` : by path of the route and status.
    answer_times : from a request to its answer.
    """

    def __init__(self) -> None:
        self.sockets = self.sent = self.skipped = 0
        self.logins: Counter[str] = Counter(dict.fromkeys(LOGINS, 0))
        self.presses: Counter[tuple[str, str]] = Counter()
        self.answers: Counter[tuple[str, str]] = Counter()
        self.delays = Durations("aff_hmi_frame_delay_seconds", DELAY_S)
        self.answer_times = Durations("aff_hmi_http_duration_seconds", ANSWER_S)

    def samples(self, sessions: Counter[str] | None) -> Iterator[Sample | MetricHistogram]:
        """Yield every number.

        Parameters
        ----------
        sessions : by role; None on a screen for looking only.
        """
        yield Sample("aff_hmi_sockets", (), self.sockets)
        yield Sample("aff_hmi_frames_total", (), self.sent)
        yield Sample("aff_hmi_frames_skipped_total", (), self.skipped)
        yield self.delays.histogram()
        yield self.answer_times.histogram()
        for answer, count in self.answers.items():
            yield Sample("aff_hmi_http_requests_total", answer, count)
        if sessions is None:
            return
        yield from (Sample("aff_hmi_sessions", (role,), n) for role, n in sessions.items())
        yield from (Sample("aff_hmi_logins_total", (how,), n) for how, n in self.logins.items())
        for which, count in self.presses.items():
            yield Sample("aff_hmi_presses_total", which, count)
