"""What an order does in the error: its amplitude before and now, and where it is going."""

from __future__ import annotations

import math
from enum import IntEnum

TURNS = 2.0  # time constant of the lock-in, turns of the roll
MIN_TAU_S = 0.5  # and at least so long
SLOW = 3.0  # time constant of the slow mean, in those of the lock-in
ROSE = 1.3  # ripple over that before, above which an order diverges
FELL = 0.95  # ripple over its slow mean, below which it still falls
SETTLED = 0.3  # ripple over that before, up to which an order is settled
SLOWEST_RAD_S = 1e-3  # below this a roll stands still


class OrderState(IntEnum):
    """State of an order, for telemetry; under the shape law one that is RISING rests."""

    IDLE = 0
    CONVERGING = 1
    SETTLED = 2
    STALLED = 3
    RISING = 4
    HELD_PHASE = 5
    HELD_FREQUENCY = 6
    CLAMPED = 7
    FROZEN = 8


class OrderMonitor:
    """Lock-in on one order: 2 e e^{-j psi}, averaged over about two turns of the roll.

    ``before`` follows the ripple while no correction goes out and stands still after that;
    NaN until two turns were seen.
    """

    __slots__ = ("_age", "_phasor", "_slow", "before", "now")

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget everything, as after a splice."""
        self._phasor = 0j
        self._slow = 0.0
        self._age = 0.0
        self.before = math.nan
        self.now = math.nan

    def step(
        self, *, error: float, carrier: complex, omega_rad_s: float, dt_s: float, correcting: bool
    ) -> None:
        """Take one good sample; ``omega_rad_s`` is the speed of the roll, not of the order."""
        omega = abs(omega_rad_s)
        if not omega > SLOWEST_RAD_S:
            return
        tau_s = TURNS * math.tau / omega
        share = dt_s / (tau_s if tau_s > MIN_TAU_S else MIN_TAU_S)
        age = self._age + share
        self._age = age = age if age < SLOW else SLOW
        pull = share if age >= 1.0 else min(1.0, share / age)
        self._phasor += pull * (2.0 * error * carrier.conjugate() - self._phasor)
        amplitude = abs(self._phasor)
        self._slow += min(1.0, share / age) * (amplitude - self._slow)
        if age < 1.0:
            return
        self.now = amplitude
        if not correcting or not math.isfinite(self.before):
            self.before = amplitude

    def state(self) -> OrderState:
        """Return where the order is going, from now against before and against its slow mean."""
        if not (math.isfinite(self.now) and math.isfinite(self.before)):
            return OrderState.IDLE
        if self.now > ROSE * self.before and self.now > FELL * self._slow:
            return OrderState.RISING
        if self.now <= SETTLED * self.before:
            return OrderState.SETTLED
        return OrderState.CONVERGING if self.now < FELL * self._slow else OrderState.STALLED
