"""Does a column help? Its ripple with and without correction, and when it has to rest.

A column of the law is one order of one roll, or the imbalance.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
import numpy.typing as npt

from aff_runtime.core.compiled.binary import chosen, holding
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.shape.columns import ColumnState

Complexes = npt.NDArray[np.complex128]
Floats = npt.NDArray[np.float64]
TURNS = 2.0
"""Memory of the lock-in: one turn parts neighbouring orders, two are steady enough to judge."""
SLOW_TURNS = 8.0
"""Memory of the mean that the newest amplitude is compared with: is it still falling?"""
HARM_RATIO, HARM_TURNS = 1.4, 4.0
"""Ripple over that without correction, and for how many turns: 1 is no help at all. 0.4
more, for two memories of the lock-in, is told from chance and from a ramp."""
NOISE_SDS = 3.0
"""Standard deviations of the lock-in's noise that are no harm."""
SETTLED_RATIO = 0.3
"""Ripple over that without correction below which a column counts as settled: 10 dB."""
CONVERGING_RATIO = 0.95
"""Ripple over its slow mean below which it still falls."""
LOST_RATIO, LOST_SHARE, LOST_TURNS = 0.1, 0.7, 2.0
"""P over the assumed one, ripple over that without correction, and for how many turns: with a
drive that does not take corrections the first is 0 and the second 1."""
REST_TURNS = 20.0
"""Length of a rest; after it the column is tried again: the cause may have gone."""
FADE_S = 1.0
"""Of a share: slow enough not to be felt as a step."""
JUDGE_TICKS = 8
"""Amplitudes are read and judged every so many ticks: within a memory they change little."""
NUMBERS = np.array(
    [TURNS, SLOW_TURNS, HARM_RATIO, HARM_TURNS, LOST_RATIO, LOST_SHARE, LOST_TURNS, REST_TURNS]
)


# members of an enum are looked up once: each look costs as much as a comparison of ten numbers
_IDLE, _RISING, _SETTLED = OrderState.IDLE, OrderState.RISING, OrderState.SETTLED
_CONVERGING, _STALLED = OrderState.CONVERGING, OrderState.STALLED


class Estimate(Protocol):
    """What a filter estimates per column: disturbance, m, and true P over the assumed one."""

    deviation: Complexes
    response_ratio: Complexes


class ShapeMonitor:
    """Per column: amplitude in the signal now (lock-in over two turns) and without correction.

    ``without`` is what the filter attributes to the roll: |a_n| |phi_n|, with phi_n the signal per
    metre of the weight (size and angle). A column whose ripple stays above 1.4 times that, and
    above its noise, for four turns does harm. One whose P has shrunk below a tenth while
    0.7 of it is left, for two turns, has lost its effect (a drive that does not take the
    correction), and its weight would wind up against nothing. Either way its ``share`` fades to
    zero within a second and it rests for twenty turns; ``dropped`` marks one that had lost its
    effect in the tick in which the last of it goes out, so that it can start anew. An imbalance
    (``imbalance_pair``) rests with order 1, whose P it shares. Columns that meet in frequency are
    not judged: the signal cannot tell them apart, so ``meets`` marks them, and nothing learned
    then is worth saving.
    """

    __slots__ = (
        "_age",
        "_bad",
        "_compiled",
        "_compiled_arrays",
        "_imbalance_pair",
        "_judged",
        "_lost",
        "_lost_effect",
        "_noise",
        "_others",
        "_passed_s",
        "_phasor",
        "_pull",
        "_rest",
        "_size",
        "_slow",
        "_ticks",
        "_work",
        "calm",
        "dropped",
        "meets",
        "now",
        "share",
        "without",
    )

    def __init__(
        self,
        state: ColumnState,
        roll_of: Sequence[str],
        signal_sd: float,
        imbalance_pair: tuple[int, int] = (-1, -1),
    ) -> None:
        count = state.count
        names = np.array(roll_of)
        self._others = names[:, None] != names[None, :]
        self._phasor = state.array("monitor.phasor", dtype=np.complex128, of_roll=True)
        self._work = np.zeros(count, dtype=np.complex128)
        self._size = np.zeros(count)
        self._pull = state.array("monitor.pull")
        self._slow = state.array("monitor.slow", of_roll=True)
        self._age = state.array("monitor.age_turns", of_roll=True)
        self._bad = state.array("monitor.bad_turns", of_roll=True)
        self._lost = state.array("monitor.lost_turns", of_roll=True)
        self._lost_effect = state.array("monitor.astray", False, dtype=np.bool_)
        self._imbalance_pair = imbalance_pair
        self._judged = state.array("monitor.judged_turns", of_roll=True)
        self._rest = state.array("monitor.rest_turns", of_roll=True)
        self._noise = signal_sd
        self._ticks = 0
        self._passed_s = 0.0
        self.now = state.array("monitor.now", math.nan, of_roll=True)
        self.without = state.array("monitor.without", math.nan, of_roll=True)
        self.share = state.array("monitor.share", 1.0)
        self.meets = state.array("monitor.meets", False, dtype=np.bool_)
        self.dropped = state.array("monitor.dropped", False, dtype=np.bool_)
        self.calm = True  # no column rests or is on its way
        self._compiled = chosen()
        self._compiled_arrays = holding(
            *(self._pull, self._phasor, self._size, self.now, self._age, self._slow, self._bad),
            *(self._lost, self._judged, self._rest, self.without, self._lost_effect, self.meets),
            *(self.share, NUMBERS),
        )

    def step(
        self, error: float, phi: Complexes, found: Estimate, turn_s: Floats, dt_s: float
    ) -> None:
        """Take one good sample; ``phi``: signal per metre of every column's weight, complex.

        ``found`` is the filter's estimate. The lock-in runs with every sample, sizes and verdicts
        every eighth.
        """
        passed_s = self._lock_in(error, phi, turn_s, dt_s)
        if passed_s is not None:
            self.calm = self._judge(passed_s, found, turn_s, dt_s)
        if not self.calm:
            change = dt_s / FADE_S
            target = np.where(self._rest > 0.0, -change, change)
            out = self.share > 0.0
            self.share += target
            np.clip(self.share, 0.0, 1.0, out=self.share)
            np.logical_and(out & (self.share == 0.0), self._lost_effect, out=self.dropped)

    def listen(self, error: float, phi: Complexes, turn_s: Floats, dt_s: float) -> None:
        """Take a sample while nothing goes out: what is there without correction, unjudged."""
        if self._lock_in(error, phi, turn_s, dt_s) is not None:
            self._judged[:] = 0.0

    def _lock_in(self, error: float, phi: Complexes, turn_s: Floats, dt_s: float) -> float | None:
        """Follow every column's amplitude; return the time since it was last read, when it is."""
        passed_s = None
        if self._ticks % JUDGE_TICKS == 0:
            passed_s, self._passed_s = self._passed_s, 0.0
            self._read_amplitudes(turn_s, passed_s, dt_s)
        self._ticks += 1
        self._passed_s += dt_s
        if self._compiled is not None:
            self._compiled.monitor_follow(self._compiled_arrays, phi, error)
        else:
            self._follow(error, phi)
        return passed_s

    def _read_amplitudes(self, turn_s: Floats, passed_s: float, dt_s: float) -> None:
        """Read every amplitude, and set how fast it is followed from now on."""
        if self._compiled is not None:
            self._compiled.monitor_hear(self._compiled_arrays, turn_s, passed_s, dt_s)
            return
        turns_per_tick = dt_s / turn_s
        np.minimum(self._age + passed_s / turn_s, SLOW_TURNS, out=self._age)
        # a roll that has not turned yet pulls nothing
        memory = np.minimum(np.maximum(self._age, np.maximum(turns_per_tick, 1e-12)), TURNS)
        np.divide(turns_per_tick, memory, out=self._pull)
        np.abs(self._phasor, out=self.now)

    def _follow(self, error: float, phi: Complexes) -> None:
        work, size = self._work, self._size
        np.abs(phi, out=size)
        np.maximum(size, 1e-9, out=size)
        np.conjugate(phi, out=work)
        work /= size
        work *= 2.0 * error
        work -= self._phasor
        work *= self._pull
        self._phasor += work

    def _judge(self, passed_s: float, found: Estimate, turn_s: Floats, dt_s: float) -> bool:
        """Judge of every column whether it helps; return whether all is calm."""
        if self._compiled is not None:
            numbers = (passed_s, dt_s, self._noise, *self._imbalance_pair)
            deviation, ratio = found.deviation, found.response_ratio
            return self._compiled.monitor_judge(
                self._compiled_arrays, turn_s, deviation, ratio, *numbers
            )
        turns = passed_s / turn_s
        self._judged += turns
        memory = np.minimum(self._judged, SLOW_TURNS)
        self._slow += turns / np.maximum(memory, np.maximum(turns, 1e-9)) * (self.now - self._slow)
        np.multiply(np.abs(found.deviation), self._size, out=self.without)
        # what white noise of one reading leaves in a lock-in over two turns
        noise = 2.0 * self._noise * np.sqrt(dt_s / (TURNS * turn_s))
        bad = (self.now > HARM_RATIO * self.without + NOISE_SDS * noise) & (self._judged > TURNS)
        bad &= ~self.meets
        self._bad[:] = np.where(bad, self._bad + turns, 0.0)
        lost = np.abs(found.response_ratio) < LOST_RATIO
        lost &= self.now > LOST_SHARE * self.without
        self._lost[:] = np.where(lost, self._lost + turns, 0.0)
        started = ((self._bad > HARM_TURNS) | (self._lost > LOST_TURNS)) & (self._rest <= 0.0)
        self._lost_effect[:] = np.where(started, self._lost > LOST_TURNS, self._lost_effect)
        self._rest[:] = np.where(started, REST_TURNS, np.maximum(0.0, self._rest - turns))
        self._bad[started] = self._lost[started] = 0.0
        first, imbalance = self._imbalance_pair
        if imbalance >= 0 and self._rest[first] > self._rest[imbalance]:
            for part in (self._rest, self._lost_effect):
                part[imbalance] = part[first]
        return not self._rest.any() and bool((self.share == 1.0).all())

    @property
    def has_two_turns(self) -> bool:
        """Whether every column was followed for two turns."""
        return bool((self._age >= TURNS).all())

    def compare(self, frequency_Hz: Floats, turn_s: Floats, memory_turns: float) -> None:
        """Mark columns of different rolls that their memories cannot tell apart."""
        apart = np.abs(frequency_Hz[:, None] - frequency_Hz[None, :])
        memory_s = memory_turns * np.maximum.outer(turn_s, turn_s)
        np.any(self._others & (apart * memory_s < 1.0), axis=1, out=self.meets)

    @property
    def resting(self) -> npt.NDArray[np.bool_]:
        """Columns whose share goes to zero for ``REST_TURNS``: harmful, or without effect."""
        return self._rest > 0.0

    @property
    def rest_turns(self) -> Floats:
        """Turns that each column still rests."""
        return self._rest

    def is_settled(self, at: int) -> bool:
        """Return whether column ``at`` was judged for two turns and is quiet by 10 dB."""
        judged, rests = self._judged.item(at) >= TURNS, self._rest.item(at) > 0.0
        return judged and not rests and self.now.item(at) <= SETTLED_RATIO * self.without.item(at)

    def judge_at_once(self) -> None:
        """Read amplitudes with the next sample: what was forgotten begins with a short memory."""
        self._ticks = 0

    def adopt(self, old: ShapeMonitor) -> None:
        """Go on where ``old`` stands, once the arrays per column are taken over."""
        self._ticks, self._passed_s = old._ticks, old._passed_s
        self.calm = not self._rest.any() and bool((self.share == 1.0).all())

    def states(self) -> list[OrderState]:
        """Return where every column stands."""
        of = self.now, self.without, self._judged, self._rest, self._bad, self._slow
        return [_state(*column) for column in zip(*(each.tolist() for each in of), strict=True)]


def _state(
    now: float, without: float, judged: float, rest: float, bad: float, slow: float
) -> OrderState:
    """Return where a column stands: its ripple, and turns of being judged, resting, doing harm."""
    if not (math.isfinite(now) and math.isfinite(without)) or judged < TURNS:
        return _IDLE
    if rest > 0.0 or bad > 1.0:
        return _RISING
    if now <= SETTLED_RATIO * without:
        return _SETTLED
    return _CONVERGING if now < CONVERGING_RATIO * slow else _STALLED
