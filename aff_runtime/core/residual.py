"""The error an actuator's law works on: reference minus signal, its slow mean taken out."""

from __future__ import annotations

import math

ABSURD = 1e6  # no tension (N) or speed (m/s) error is that large; it would spoil the mean


class Residual:
    """e = y_ref - y (or -y without a reference) minus its slow mean.

    The mean covers what has been seen until ``tau_s``, so the first seconds are no step. What the
    high-pass does to an order is told by ``response`` and belongs into P. Duplicate samples give
    NaN; ``elapsed_s`` is the time since the last good one.
    """

    __slots__ = ("_mean", "_pending_s", "_seen_s", "_tau_s", "elapsed_s", "value")

    def __init__(self, tau_s: float) -> None:
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

    def response(self, frequency_Hz: float) -> complex:
        """Return the high-pass jwT / (1 + jwT) at a frequency."""
        turn = 1j * math.tau * frequency_Hz * self._tau_s
        return turn / (1.0 + turn)
