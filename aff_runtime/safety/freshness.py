"""Is the PLC still alive? Judged by its heartbeat, not by answers that merely arrive."""

from __future__ import annotations

from enum import IntEnum
from math import inf

from aff_runtime.base.signals import Outcome, Snapshot
from aff_runtime.safety.params import FreshnessParams

_OK = Outcome.OK
_EDGE_S = 1e-6  # exactly on the edge is still in time, whatever the rounding


class Freshness(IntEnum):
    """How far the PLC's data may be trusted."""

    GOOD = 0
    HOLD = 1
    STALE = 2


class FreshnessCheck:
    """Ages the PLC's heartbeat by the snapshot's account and by its own; the older one counts.

    Never raises. A snapshot whose age is NaN or negative is as old as can be.
    """

    def __init__(self, params: FreshnessParams) -> None:
        self.params = params
        self._moved_ns: int | None = None

    def judge(self, snapshot: Snapshot, now_ns: int) -> Freshness:
        """Return the trust in ``snapshot`` at ``now_ns``."""
        if snapshot.fresh and snapshot.outcome is _OK:
            self._moved_ns = now_ns
        own_age_s = inf if self._moved_ns is None else (now_ns - self._moved_ns) * 1e-9
        age_s = snapshot.age_s if snapshot.age_s >= 0.0 else inf
        age_s = max(own_age_s, age_s)
        age_s -= _EDGE_S
        if age_s > self.params.fault_after_s:
            return Freshness.STALE
        if age_s > self.params.hold_after_s:
            return Freshness.HOLD
        return Freshness.GOOD
