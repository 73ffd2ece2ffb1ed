"""One memory for all orders: a Kalman filter of disturbance and response ratio per column."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from aff_runtime.core.compiled.binary import chosen, holding
from aff_runtime.core.shape.columns import ColumnMap

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
START_DEVIATION_M = 1e-3  # standard deviation of re and im of a_n at the start
START_CORRECTION = 0.6  # the same of d_n
CORRECTION_PER_TURN = 0.01  # by which d_n walks, per root of a turn
CORRECTION_PER_OCTAVE = 0.15  # by which d_n walks, per root of an octave
TRAVEL_OCTAVES = 0.02  # a frequency that moved by less since it was noted has not moved
BIAS_SDS_PER_SQRT_S = 0.17  # by which the bias walks, standard deviations of a reading
START_BIAS = 30.0  # standard deviation of the bias at the start, in those of a reading
SMALLEST_GAIN = 1e-6  # information of a turn, at least, over that of the start
KNOWN_SHARE = 0.2  # standard deviation of a known shape: of its size,
KNOWN_M = 3e-5  # and this on top
KNOWN_RATIO = 0.2  # standard deviation of a known d_n
PREDICT_TICKS = 8  # readings from one addition of process noise to the next
NEWS_LIMIT = 10.0
"""Expected standard deviations by which a reading may move the state. In tension none is 6 off on
the benches' lines, start-up, steps of speed and mismatched drives included; a spike of 100 N is
165. A follower's speed, whose ripple of other rolls is no noise, may be 40 off, and learns."""
NUMBERS = np.array(
    [
        SMALLEST_GAIN / START_DEVIATION_M**2,
        CORRECTION_PER_TURN,
        CORRECTION_PER_OCTAVE,
        TRAVEL_OCTAVES,
        BIAS_SDS_PER_SQRT_S,
    ]
)


class ShapeFilter:
    r"""Estimates a_n, g_n and a bias from  e = Re sum_n a_n phi_n + g_n psi_n + bias.

    ``a_n`` is what would be there without correction, in metres of column n; g_n = 1 + d_n is the
    true P over the assumed one at that column's frequency. Process noise of a_n is set from the
    information one turn brings, (1/memory)^2 / info_n, so every column forgets after the same
    number of turns. d_n belongs to a frequency: it walks 0.15 in an octave that its order moves,
    and 0.01 in a turn for what changes on the line itself; variances add. None grows past its
    start value.

    State, real: a_n and g_n as pairs re, im (n pairs each), bias. The covariance is updated by a
    rank-one product of a vector with itself, which keeps it symmetric; process noise is added
    every eighth reading for all of them. What is further off than any noise (a spike in a load
    cell) counts as if it were ``NEWS_LIMIT`` of its standard deviations off. An imbalance has the
    frequency of order 1 and no g of its own: with ``imbalance_pair`` (order 1, imbalance) psi of
    both counts as one.
    """

    __slots__ = (
        "_K",
        "_compiled",
        "_diagonal",
        "_drift",
        "_fresh",
        "_h",
        "_held",
        "_imbalance_pair",
        "_memory_turns",
        "_noise",
        "_none",
        "_passed_s",
        "_sd",
        "_seen",
        "_start",
        "_ticks",
        "_turn_s",
        "_work",
        "count",
        "covariance",
        "deviation",
        "innovation",
        "response_ratio",
        "state",
    )

    def __init__(
        self,
        count: int,
        memory_turns: float,
        signal_sd: float,
        drift: Floats | None = None,
        imbalance_pair: tuple[int, int] = (-1, -1),
    ) -> None:
        """``drift``, (count,): share of the process noise of a_n per column, 1 when not given."""
        self.count = count
        self._drift = np.ones(count) if drift is None else drift
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
        self._fresh = np.zeros(size)
        self._fresh[2 * count : 4 * count : 2] = 1.0
        self.state = self._fresh.copy()
        # disturbance a_n, m, and 1 + d_n: the state itself, seen as complex numbers
        self.deviation = self.state[: 2 * count].view(np.complex128)
        self.response_ratio = self.state[2 * count : 4 * count].view(np.complex128)
        self.covariance = np.diag(self._start)
        self._diagonal = self.covariance.ravel()[:: size + 1]
        self._h = np.zeros(size)
        self._h[-1] = 1.0
        self._seen = self._h[:-1].view(np.complex128).reshape(2, count)
        self._K = np.zeros(size)
        self._work = np.zeros((size, size))
        self._noise = np.zeros(size)
        self._turn_s = np.full(count, math.nan)
        self._none = np.zeros(count)
        self._passed_s = 0.0
        self._ticks = 0
        self.innovation = 0.0
        self._imbalance_pair = imbalance_pair
        self._compiled = chosen()
        self._held = holding(
            self._drift, self.state, self.covariance, self._h, self._K, self._start, self._turn_s
        )

    @property
    def response_ratio_less_1(self) -> Complexes:
        """Its d_n: how far P is from the assumed one."""
        return self.response_ratio - 1.0

    def update(
        self, error: float, phi: Complexes, psi: Complexes, turn_s: Floats, dt_s: float
    ) -> None:
        """Take one reading of the signal's deviation from its reference; ``psi`` is used up."""
        if self._compiled is not None:
            self.innovation = self._compiled.filter_update(
                self._held, phi, psi, error, self._sd, NEWS_LIMIT, *self._imbalance_pair
            )
        else:
            self._update(error, phi, psi)
        self._passed_s += dt_s
        self._ticks += 1
        if self._ticks % PREDICT_TICKS == 0:
            self._predict(phi, turn_s, self._passed_s, dt_s)
            self._passed_s = 0.0

    def _update(self, error: float, phi: Complexes, psi: Complexes) -> None:
        h, P, K = self._h, self.covariance, self._K
        first, imbalance = self._imbalance_pair
        if imbalance >= 0:
            psi[first] += psi[imbalance]
            psi[imbalance] = 0.0
        np.conjugate(phi, out=self._seen[0])
        np.conjugate(psi, out=self._seen[1])
        self.innovation = error - float(h @ self.state)
        np.dot(P, h, out=K)
        spread = float(h @ K) + self._sd * self._sd
        K *= 1.0 / math.sqrt(spread)
        np.multiply(K[:, None], K, out=self._work)
        P -= self._work
        news = self.innovation / math.sqrt(spread)
        K *= max(min(news, NEWS_LIMIT), -NEWS_LIMIT)
        self.state += K
        if imbalance >= 0:
            self.response_ratio[imbalance] = self.response_ratio[first]

    def _predict(self, phi: Complexes, turn_s: Floats, passed_s: float, dt_s: float) -> None:
        """Add the process noise of ``passed_s``, brought in by readings every ``dt_s``."""
        if self._compiled is not None:
            self._compiled.filter_predict(
                self._held, phi, turn_s, NUMBERS, passed_s, dt_s, self._sd, self._memory_turns
            )
            return
        n, noise = self.count, self._noise
        turns = passed_s / turn_s
        info = phi.real * phi.real + phi.imag * phi.imag
        info *= 0.5 / (self._sd * self._sd)
        info *= turn_s / dt_s
        info += SMALLEST_GAIN / START_DEVIATION_M**2
        pairs = noise[:-1].reshape(2, n, 2)
        pairs[0] = (self._drift * turns / (info * self._memory_turns**2))[:, None]
        pairs[1] = (CORRECTION_PER_TURN**2 * turns + self._travelled(turn_s))[:, None]
        noise[-1] = (BIAS_SDS_PER_SQRT_S * self._sd) ** 2 * passed_s
        room = 1.0 - self._diagonal / self._start
        np.maximum(room, 0.0, out=room)
        np.minimum(noise, self._start, out=noise)
        noise *= room
        self._diagonal += noise

    def _travelled(self, turn_s: Floats) -> Floats:
        """Return what the way in frequency since the last note adds to the variance of d."""
        octaves = np.abs(np.log2(turn_s / self._turn_s))
        far = ~(octaves < TRAVEL_OCTAVES)
        if not far.any():
            return self._none
        self._turn_s[far] = turn_s[far]
        return np.where(far & np.isfinite(octaves), CORRECTION_PER_OCTAVE**2 * octaves, 0.0)

    def forget(self, columns: npt.NDArray[np.bool_], *, response: bool = False) -> None:
        """Start the disturbances of some columns again; what was learned of P if ``response``."""
        again = np.zeros(self.state.size, dtype=bool)
        again[: 2 * self.count] = np.repeat(columns, 2)
        if response:
            again[2 * self.count : -1] = again[: 2 * self.count]
        self._renew(again)

    def _renew(self, again: npt.NDArray[np.bool_]) -> None:
        self.state[again] = self._fresh[again]
        self.covariance[again, :] = 0.0
        self.covariance[:, again] = 0.0
        self._diagonal[again] = self._start[again]

    def restart(self) -> None:
        """Forget everything."""
        self._renew(np.ones(self.state.size, dtype=bool))

    def expect(self, at: int, weight_m: complex, ratio_less_1: complex | None) -> None:
        """Start column ``at`` from a known shape: its disturbance is what the weight cancels."""
        n = self.count
        shape = slice(2 * at, 2 * at + 2)
        again = np.zeros(self.state.size, dtype=bool)
        again[shape] = again[2 * (n + at) : 2 * (n + at) + 2] = True
        self._renew(again)
        self.response_ratio[at] = 1.0 + (ratio_less_1 or 0j)
        self.deviation[at] = -self.response_ratio[at] * weight_m
        known = KNOWN_SHARE * abs(weight_m) + KNOWN_M
        self._diagonal[shape] = min(known, START_DEVIATION_M) ** 2
        if ratio_less_1 is not None:
            self._diagonal[2 * (n + at) : 2 * (n + at) + 2] = KNOWN_RATIO**2

    def adopt(self, old: ShapeFilter, both: ColumnMap) -> None:
        """Go on where ``old`` stands, with what its columns know of each other."""
        mine, theirs = _entries(both.mine, self.count), _entries(both.theirs, old.count)
        self.state[mine] = old.state[theirs]
        self.covariance[np.ix_(mine, mine)] = old.covariance[np.ix_(theirs, theirs)]
        both.take(self._turn_s, old._turn_s)
        self._passed_s, self._ticks = old._passed_s, old._ticks

    def check(self) -> None:
        """Start the covariance again should rounding ever have spoilt it; the state stays."""
        if not (self._diagonal.min() > 0.0 and math.isfinite(float(self._diagonal.sum()))):
            state = np.where(np.isfinite(self.state), self.state, 0.0)
            self.restart()
            self.state[:] = state


def _entries(columns: npt.NDArray[np.int_], count: int) -> npt.NDArray[np.int_]:
    """Return where the state holds a_n and g_n of some of ``count`` columns, and the bias."""
    pairs = (2 * columns[:, None] + np.arange(2)).ravel()
    return np.concatenate([pairs, 2 * count + pairs, [4 * count]])
