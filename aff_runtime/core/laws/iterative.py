"""A block that moves once in two turns, by the mean of a whole turn: the iterative law."""

from __future__ import annotations

import cmath
import math
from typing import ClassVar

from aff_runtime.core.blocks.block import HarmonicBlock

MOVES_OVER = 0.5  # of a turn; the rest of it the line has to settle
PASS_TURNS = 2.0  # of the roll: one to move and settle, one to measure
STILL = 0.01  # share by which a weight may have changed and still stands still
WIDEST_RAD = 1.0  # between two samples of one mean; beyond it one has been missed


class IterativeBlock(HarmonicBlock):
    r"""Cancels one order of one roll: a turn to move and to settle, a turn to measure.

    Derivation. With the weight W at rest and what its last move has set off died away, the error
    of a turn is -Re((v P W + D) e^{j psi}) and whatever else repeats with the roll. The mean of
    2 e e^{-j psi} over exactly one turn of the roll is c = -(v P W + D): every other order of
    that roll gives zero, however large it is. The weight that cancels is W + c / (v P), so a pass
    moves by

        W' = W + mu c / (v P),    mu = 1 - exp(-lam T),    lam = 4 / settle_s,

    T the time of a pass, so that 1.8 % are left after ``settle_s``, as with ``HarmonicBlock``, or
    after one pass where that takes longer. With P known but for a factor (1 + d) e^{j phi} a pass
    leaves 1 - mu (1 + d) e^{j phi} of the ripple, less than one while mu (1 + d) < 2 cos phi:
    beyond 60 degrees, where the bank holds a block, even a right gain may not converge. This is
    the update once per revolution of higher harmonic control, one order at a time.

    ``HarmonicBlock`` moves with every sample and so follows every other order m of amplitude E
    too: its weight swings by lam E / (|v P| |m - n| omega), which goes out as lines beside the
    order. Here the weight stands still while it is measured. The price: what changes is answered
    one to two turns later.

    The move goes evenly over half a turn; its rate goes to the guard as every block's. Whatever
    else changes the weight (a limit in force, a roll that is forgotten) begins the measurement
    anew; so does a sample that was missed or a roll that turns back. ``hold`` ends the pass.
    """

    widest_rad: ClassVar[float] = WIDEST_RAD

    __slots__ = ("_before", "_left", "_move", "_pass_s", "_sum", "_turned_rad", "_weight_then")

    def __init__(self, order: int, settle_s: float, amp_limit: float) -> None:
        super().__init__(order, settle_s, amp_limit)
        self._move = self._before = 0j
        self._left = 0.0  # of the move
        self._begin(0j)

    def adapt(
        self, *, error: float, response: complex, scale: float, rate_1_s: float, dt_s: float
    ) -> None:
        """Take one sample of ``error`` = y_ref - y; move as the pass before has found.

        Does nothing when a move would not be a finite number.
        """
        self.weight_speed = 0.0
        turned_rad = cmath.phase(self.carrier * self._before.conjugate()) if self._before else 0.0
        self._before = self.carrier
        if abs(turned_rad) > self.widest_rad or turned_rad * self._turned_rad < 0.0:
            self._measure_anew()
            return
        whole_rad = math.tau * self.order
        at_rad = abs(self._turned_rad)
        self._turned_rad += turned_rad
        self._pass_s += dt_s
        if self._left > 0.0:
            self._move_on(abs(turned_rad) / (MOVES_OVER * whole_rad), dt_s)
        elif abs(self.weight - self._weight_then) > STILL * abs(self._weight_then):
            self._measure_anew()
            return
        end_rad = PASS_TURNS * whole_rad
        share_rad = min(abs(self._turned_rad), end_rad) - max(at_rad, end_rad - whole_rad)
        if share_rad > 0.0:
            self._sum += share_rad * error * self.carrier.conjugate()
        if abs(self._turned_rad) >= end_rad:
            self._decide(2.0 * self._sum / whole_rad, response * scale, rate_1_s)

    def _move_on(self, share: float, dt_s: float) -> None:
        """Go on with a move by a share of it."""
        step = min(share, self._left) * self._move
        self._left = max(0.0, self._left - share)
        self.weight += step
        self._weight_then = self.weight
        self.weight_speed = abs(step) / dt_s if dt_s > 0.0 else 0.0

    def _decide(self, mean: complex, per_weight: complex, rate_1_s: float) -> None:
        """Plan the next move: ``mean`` is c of the derivation, ``per_weight`` v P."""
        power = per_weight.real * per_weight.real + per_weight.imag * per_weight.imag
        move = 0j
        if power > 0.0:
            move = -math.expm1(-rate_1_s * self._pass_s) * mean * per_weight.conjugate() / power
        self._begin(move if cmath.isfinite(move) else 0j)

    def _begin(self, move: complex) -> None:
        """Begin a pass; without a move the weight rests from its start."""
        self._move = move
        self._left = 1.0 if move else 0.0
        self._turned_rad = self._pass_s = 0.0
        self._sum = 0j
        self._weight_then = self.weight

    def _measure_anew(self) -> None:
        """Rest and measure again; what is left of a move is still made."""
        left = self._left
        self._begin(self._move)
        self._left = left

    def hold(self) -> None:
        """Leave the weight as it is in this tick, and begin anew after it."""
        super().hold()
        self._before = 0j
        self._begin(0j)

    def reset(self) -> None:
        """Forget what was learned."""
        super().reset()
        self.hold()
