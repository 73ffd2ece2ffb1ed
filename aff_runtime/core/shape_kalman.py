"""One memory for all orders: a Kalman filter of disturbance and of P's correction per column."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
Seen = npt.NDArray[np.complex64] | Complexes
START_DEVIATION_M = 1e-3
START_CORRECTION = 0.6
CORRECTION_PER_TURN = 0.04
BIAS_SDS_PER_SQRT_S = 0.17
START_BIAS = 30.0
SMALLEST_GAIN = 1e-6
KNOWN_SHARE = 0.2
KNOWN_M = 3e-5


class ShapeFilter:
    r"""Estimates a_n, d_n and a bias from  e = Re sum_n a_n phi_n + (1 + d_n) psi_n + bias.

    ``a_n`` is what would be there without correction, in metres of column n; 1 + d_n is the true
    P over the assumed one at that column's frequency. Process noise of a_n is set from the
    information one turn brings, (1/memory)^2 / info_n, so every column forgets after the same
    number of turns; d_n walks 0.05 per turn. No variance grows past its start value.

    State, real: re a, im a, re d, im d (n each), bias. The covariance is updated by a rank-one
    product of a vector with itself, which keeps it symmetric.
    """

    __slots__ = (
        "_diagonal", "_ends", "_gain", "_grow", "_h", "_memory_turns", "_noise", "_power", "_sd",
        "_start", "_work", "count", "covariance", "innovation", "state",
    )  # fmt: skip

    def __init__(self, count: int, memory_turns: float, signal_sd: float) -> None:
        self.count = count
        size = 4 * count + 1
        self._memory_turns = memory_turns
        self._sd = signal_sd
        self._start = np.concatenate(
            [
                np.full(2 * count, START_DEVIATION_M**2),
                np.full(2 * count, START_CORRECTION**2),
                [(START_BIAS * signal_sd) ** 2],
            ]
        )
        self.state = np.zeros(size)
        self.covariance = np.diag(self._start)
        self._diagonal = self.covariance.ravel()[:: size + 1]
        self._h = np.zeros(size)
        self._h[-1] = 1.0
        self._gain = np.zeros(size)
        self._work = np.zeros((size, size))
        self._noise = np.zeros(size)
        self._grow = np.zeros(size)
        self._power = np.zeros(count)
        self.innovation = 0.0

    @property
    def deviation(self) -> Complexes:
        """Disturbance a_n, m."""
        n = self.count
        return self.state[:n] + 1j * self.state[n : 2 * n]

    @property
    def correction(self) -> Complexes:
        """Correction d_n of P."""
        n = self.count
        return self.state[2 * n : 3 * n] + 1j * self.state[3 * n : 4 * n]

    def step(self, error: float, phi: Seen, psi: Seen, turn_s: Floats, dt_s: float) -> None:
        """Take one reading of the signal's deviation from its reference."""
        n, h, P = self.count, self._h, self.covariance
        h[:n], h[n : 2 * n] = phi.real, -phi.imag
        h[2 * n : 3 * n], h[3 * n : 4 * n] = psi.real, -psi.imag
        predicted = float(h @ self.state) + float(psi.real.sum())
        self.innovation = error - predicted
        np.dot(P, h, out=self._gain)
        spread = float(h @ self._gain) + self._sd * self._sd
        self.state += self._gain * (self.innovation / spread)
        self._gain *= 1.0 / math.sqrt(spread)
        np.multiply.outer(self._gain, self._gain, out=self._work)
        P -= self._work
        self._forget(phi, turn_s, dt_s)

    def _forget(self, phi: Seen, turn_s: Floats, dt_s: float) -> None:
        n, noise = self.count, self._noise
        turns = dt_s / turn_s
        info = phi.real * phi.real + phi.imag * phi.imag
        info *= 0.5 / (self._sd * self._sd * turns)
        info += SMALLEST_GAIN / START_DEVIATION_M**2
        rate = turns / (info * self._memory_turns**2)
        noise[:n] = noise[n : 2 * n] = rate
        walk = CORRECTION_PER_TURN**2 * turns
        noise[2 * n : 3 * n] = noise[3 * n : 4 * n] = walk
        noise[-1] = (BIAS_SDS_PER_SQRT_S * self._sd) ** 2 * dt_s
        room = 1.0 - self._diagonal / self._start
        np.maximum(room, 0.0, out=room)
        np.minimum(noise, self._start, out=noise)
        self._diagonal += noise * room

    def forget(self, columns: npt.NDArray[np.bool_]) -> None:
        """Start the disturbances of some columns again; what was learned of P stays."""
        again = np.concatenate([np.tile(columns, 2), np.zeros(2 * self.count + 1, dtype=bool)])
        self._renew(again)

    def _renew(self, again: npt.NDArray[np.bool_]) -> None:
        self.state[again] = 0.0
        self.covariance[again, :] = 0.0
        self.covariance[:, again] = 0.0
        self._diagonal[again] = self._start[again]

    def restart(self) -> None:
        """Forget everything."""
        self._renew(np.ones(self.state.size, dtype=bool))

    def expect(self, at: int, weight_m: complex, correction: complex | None) -> None:
        """Start column ``at`` from a known shape: its disturbance is what the weight cancels."""
        n = self.count
        again = np.zeros(self.state.size, dtype=bool)
        again[[at, n + at, 2 * n + at, 3 * n + at]] = True
        self._renew(again)
        given = 0j if correction is None else correction
        deviation = -(1.0 + given) * weight_m
        self.state[[at, n + at, 2 * n + at, 3 * n + at]] = (
            deviation.real, deviation.imag, given.real, given.imag,
        )  # fmt: skip
        known = KNOWN_SHARE * abs(weight_m) + KNOWN_M
        self._diagonal[[at, n + at]] = min(known, START_DEVIATION_M) ** 2

    def adopt(self, old: ShapeFilter) -> None:
        """Go on where a filter of the same columns stands."""
        self.state[:] = old.state
        self.covariance[:] = old.covariance

    def check(self) -> None:
        """Start the covariance again should rounding ever have spoilt it; the state stays."""
        if not (self._diagonal.min() > 0.0 and math.isfinite(float(self._diagonal.sum()))):
            state = np.where(np.isfinite(self.state), self.state, 0.0)
            self.restart()
            self.state[:] = state
