"""The error an actuator's law works on: reference minus signal, its slow mean taken out."""

from __future__ import annotations

import math

ABSURD = 1e6  # no tension (N) or speed (m/s) error is that large; it would spoil the mean


CORNER_SHARE = 0.3  # corner of the high-pass over the slowest order's frequency
SHORTEST_S = 0.05  # time constant, at least


class Residual:
    """e = y_ref - y (or -y without a reference) minus its slow mean.

    The mean covers what has been seen until the time constant, so the first seconds are no step.
    The time constant follows the slowest order, at most ``tau_s``: a zone without a tension loop
    answers to a slow correction tens of times stronger than to an order, and a block that learned
    from it would close a loop at zero frequency and run away (at 200 FPM a follower block
    with settle_s 8 swung the pull-roll tension by 25 N rms). What the high-pass does to an order
    is what ``response`` returns; it belongs into P. Duplicate samples give NaN; ``elapsed_s`` is
    the time since the last good one.
    """

    __slots__ = ("_longest_s", "_mean", "_pending_s", "_seen_s", "_tau_s", "elapsed_s", "value")

    def __init__(self, tau_s: float) -> None:
        self._longest_s = tau_s
        self._tau_s = tau_s
        self._mean = 0.0
        self._seen_s = 0.0
        self._pending_s = 0.0
        self.elapsed_s = 0.0
        self.value = math.nan

    def step(self, *, signal: float, reference: float, dt_s: float, fresh: bool) -> float:
        """Return the error of a fresh finite sample, NaN for any other."""
        self._pending_s += dt_s
        error = (reference if math.isfinite(reference) else 0.0) - signal
        if not (fresh and abs(error) < ABSURD):
            self.value = math.nan
            return self.value
        self.elapsed_s = self._pending_s
        self._pending_s = 0.0
        self._seen_s = min(self._seen_s + self.elapsed_s, self._tau_s)
        self._mean += min(1.0, self.elapsed_s / self._seen_s) * (error - self._mean)
        self.value = error - self._mean
        return self.value

    def follow(self, slowest_rad_s: float) -> None:
        """Set the time constant for the slowest order that turns, rad/s; 0 when none does."""
        if slowest_rad_s > 0.0:
            tau_s = 1.0 / (CORNER_SHARE * slowest_rad_s)
            self._tau_s = min(max(tau_s, SHORTEST_S), self._longest_s)

    def response(self, frequency_Hz: float) -> complex:
        """Return the high-pass jwT / (1 + jwT) at a frequency."""
        turn = 1j * math.tau * frequency_Hz * self._tau_s
        return turn / (1.0 + turn)
