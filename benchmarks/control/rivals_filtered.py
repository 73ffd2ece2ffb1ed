"""FxLMS: gradient descent on filtered carriers, with the same P, orders and fade as the law."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from aff_runtime.base.signals import ActuatorStep
from aff_runtime.core.impulse import LoopModel
from aff_runtime.core.law import ActuatorLaw, Inputs
from aff_runtime.core.phase import RollPhase
from aff_runtime.core.shape.filter import LoopFilter


class Rival:
    """What every rival shares: it learns nothing lasting, names nothing, objects to nothing."""

    def reset_roll(self, roll: str) -> None:
        """Keep everything: the rivals know no rolls."""

    def weights(self) -> Mapping[tuple[str, int], complex]:
        """Return nothing."""
        return {}

    def adopt(self, old: ActuatorLaw) -> None:
        """Start anew."""

    def objections(self) -> tuple[str, ...]:
        """Return none."""
        return ()

    def ripple(self) -> tuple[float, float]:
        """Return nothing known."""
        return math.nan, math.nan

    def telemetry(self) -> tuple[float, ...]:
        """Return nothing."""
        return ()

    def telemetry_names(self) -> tuple[str, ...]:
        """Return nothing."""
        return ()


class FxLms(Rival):
    """Filtered-x LMS per order on padasip's ``FilterLMS``: v = Re sum w_n q_n.

    The regressor is every carrier seen through P and made one in size, P[q_n] / |P[q_n]|, as
    pairs of reals; so one step size serves all orders (normalised LMS per order). padasip takes a
    target and forms the error itself: given prediction minus measured error as target, its error
    is the measured one with the sign that makes the ripple fall. ``turns`` is the time constant.
    """

    def __init__(
        self,
        phases: Mapping[str, RollPhase],
        cycle_s: float,
        loop: LoopModel,
        *,
        orders: int,
        turns: float,
        fade_Hz: tuple[float, float] = (14.0, 16.0),
    ) -> None:
        columns = [("unwind", n) for n in range(1, orders + 1)] + [("swrap_follower", 1)]
        count = len(columns)
        self._phases = [phases[roll] for roll, _ in columns]
        self._order = np.array([float(n) for _, n in columns])
        self._filter = LoopFilter(loop, count)
        self._own = phases["unwind"]
        from padasip.filters import FilterLMS  # with scipy.stats, half the start of a worker

        self._lms = FilterLMS(2 * count, mu=0.0, w="zeros")
        self._w = np.zeros(count, dtype=np.complex128)
        self._q = np.zeros(count, dtype=np.complex128)
        self._lead_s = 1.5 * cycle_s
        self._turns = turns
        self._fade_Hz = fade_Hz
        self._size = np.full(count, 1e-3)

    def step(self, inputs: Inputs) -> ActuatorStep:
        """Advance by one tick."""
        dt_s = inputs.dt_s
        if inputs.limit_ratio < 1.0:
            self._w *= inputs.limit_ratio
        self._filter.follow_radius(self._own.radius_m)
        self._filter.push(self._q, self._q, 1.0, 1)
        if inputs.adapt:
            self._adapt(inputs.signal - inputs.reference, dt_s)
        angle = np.array([phase.lead(self._lead_s) for phase in self._phases])
        omega = np.array([phase.omega_rad_s for phase in self._phases])
        frequency = np.abs(self._order * omega) / math.tau
        low, high = self._fade_Hz
        fade = np.clip((high - frequency) / (high - low), 0.0, 1.0)
        self._q = fade * np.exp(1j * self._order * angle)
        value = float((self._w * self._q).real.sum())
        return ActuatorStep(value=value, peak_bound=max(abs(value), 1e-9), slew_bound=0.0)

    def _adapt(self, error: float, dt_s: float) -> None:
        seen, _ = self._filter.read()
        power = seen.real**2 + seen.imag**2
        self._size += dt_s * (power - self._size)
        size = np.sqrt(np.maximum(self._size, 1.0))
        x = np.conj(seen / size).astype(np.complex128).view(np.float64)
        lms = self._lms
        lms.mu = 2.0 * dt_s * abs(self._own.omega_rad_s) / (math.tau * self._turns)
        lms.w = (self._w * size).view(np.float64)
        lms.adapt(float(lms.predict(x)) - error, x)
        self._w = lms.w.view(np.complex128) / size
