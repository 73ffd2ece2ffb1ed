"""One adaptive harmonic block: the source's law with its sign and phase put right."""

from __future__ import annotations

import cmath
import math
from typing import ClassVar

SETTLE_EXPONENT = 4.0  # exp(-4) = 1.8 % of the ripple is left after settle_s
MEMORY_SHARE = 0.3  # adaptation rate times memory of the response stays below this
MAX_STEP = 0.1  # share of the remaining error that one sample may remove


class HarmonicBlock:
    r"""Cancels one order of one roll in one measured signal.

    Derivation. The source writes (5.6) u = -theta_1 sin(psi) - theta_2 cos(psi) with
    psi = omega t, adapted by (5.5) theta_1' = g1 e sin(psi), theta_2' = g1 e cos(psi),
    e = y_r - y, and (5.7) the same with psi + phi. Here psi = n theta(roll) is a measured angle,
    and with the complex weight W = -theta_2 + j theta_1 the output is

        u = v Re(W e^{j psi}),    v = 1, or the roll's speed so that W is in metres.

    P is the closed-loop response from u to y at that frequency, so in steady state
    y - y_r = Re((v P W + D) e^{j psi}), D being the disturbance. The mean of 2 e e^{-j psi}
    over a turn is therefore -(v P W + D). Asking for W' = -lam (W + D/(v P)) gives

        W' = (2 lam / (v |P|)) e e^{-j (psi + phi)},    phi = arg P,

    which decays as exp(-lam t) for every phase of P. In the source's symbols that is
    theta_1' = g1 e sin(psi + phi), theta_2' = g1 e cos(psi + phi) with g1 = -2 lam / |P|: for
    phi = arg P the gain of (5.7) is NEGATIVE (or positive with phi = arg(-P)); (5.10) as printed
    has g1 > 0 on Re P > 0 and diverges, (5.14) has Re P < 0 and converges only while
    |arg(-P)| < 90 degrees. lam = 4 / settle_s, hence exp(-4) = 1.8 % after ``settle_s``.

    The mean assumes that P is flat over the adaptation bandwidth. P(j omega + s), s the Laplace
    variable, is about P(j omega) (1 + s m) with m = -j dlnP/domega, the memory of the response;
    lam |m| is kept below 0.3.

    ``weight_speed`` is how fast the weight moved in the last tick, in its unit per second.
    """

    widest_rad: ClassVar[float] = math.inf
    """How far the order may turn between two readings that it learns from."""

    __slots__ = ("amp_limit", "carrier", "clamped", "order", "settle_s", "weight", "weight_speed")

    def __init__(self, order: int, settle_s: float, amp_limit: float) -> None:
        self.order = order
        self.settle_s = settle_s
        self.amp_limit = amp_limit
        self.weight = 0j
        self.carrier = 1 + 0j
        self.weight_speed = 0.0
        self.clamped = False

    def turn(self, theta_rad: float) -> None:
        """Set the carrier to the roll's angle (already led by the transport of the command)."""
        self.carrier = cmath.rect(1.0, self.order * theta_rad)

    def output(self, scale: float) -> float:
        """Return v Re(W e^{j psi}), the output (5.6)."""
        return scale * (self.weight * self.carrier).real

    def amplitude(self, scale: float) -> float:
        """Return the amplitude of the output at ``scale``, in the output's unit."""
        return abs(scale) * abs(self.weight)

    def adaptation_rate(self, memory_s: float) -> float:
        """Return lam, 1/s: what ``settle_s`` asks, bounded by the memory of the response."""
        rate = SETTLE_EXPONENT / self.settle_s
        return min(rate, MEMORY_SHARE / memory_s) if memory_s > 0.0 else rate

    def adapt(
        self, *, error: float, response: complex, scale: float, rate_1_s: float, dt_s: float
    ) -> None:
        """Advance the weight by ``dt_s`` under ``error`` = y_ref - y; see the derivation.

        ``response`` is P, ``scale`` v, ``rate_1_s`` lam. Does nothing when the step would not be
        a finite number.
        """
        per_weight = response * scale
        power = per_weight.real * per_weight.real + per_weight.imag * per_weight.imag
        if not power > 0.0:
            return
        share = min(rate_1_s * dt_s, MAX_STEP)
        step = (2.0 * share * error / power) * (self.carrier * per_weight).conjugate()
        if not cmath.isfinite(step):
            return
        self.weight += step
        self.weight_speed = abs(step) / dt_s

    def hold(self) -> None:
        """Leave the weight as it is in this tick."""
        self.weight_speed = 0.0

    def scale_weights(self, ratio: float) -> None:
        """Shorten the weight to ``ratio`` (0..1) of itself; its direction stays."""
        if 0.0 <= ratio < 1.0:
            self.weight *= ratio

    def reset(self) -> None:
        """Forget what was learned."""
        self.weight = 0j
        self.weight_speed = 0.0
        self.clamped = False

    def limit(self, scale: float) -> float:
        """Project the weight onto its amplitude limit at ``scale`` and return the amplitude.

        Call once per tick.
        """
        amplitude = abs(scale) * abs(self.weight)
        self.clamped = amplitude > self.amp_limit
        if self.clamped:
            self.weight *= self.amp_limit / amplitude
            amplitude = abs(scale) * abs(self.weight)
        return amplitude
