"""FxLMS: gradient descent on filtered carriers, with the same P, orders and fade as the law."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from aff_runtime.base.signals import ActuatorStep
from aff_runtime.core.impulse import LoopModel
from aff_runtime.core.law import ActuatorLaw, Inputs
from aff_runtime.core.phase import RollPhase
from aff_runtime.core.shape_filter import LoopFilter

FADE_FROM_HZ, FADE_TO_HZ = 14.0, 16.0
MEAN_S = 10.0


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
    """v = Re sum w_n q_n, w_n <- w_n - mu e conj(P[q_n]) / |P[q_n]|^2 (normalised, ``turns``).

    The filter the literature offers (padasip's NLMS) is this update for a regressor of filtered
    carriers; written out here because the error is measured, not computed from a target.
    """

    def __init__(
        self,
        phases: Mapping[str, RollPhase],
        cycle_s: float,
        loop: LoopModel,
        *,
        columns: list[tuple[str, int]],
        turns: float,
    ) -> None:
        self._phases = [phases[roll] for roll, _ in columns]
        self._order = np.array([float(n) for _, n in columns])
        self._filter = LoopFilter(loop, len(columns))
        self._own = phases[columns[0][0]]
        self._w = np.zeros(len(columns), dtype=np.complex128)
        self._q = np.zeros(len(columns), dtype=np.complex128)
        self._lead_s = 1.5 * cycle_s
        self._turns = turns
        self._mean = math.nan
        self._size = np.full(len(columns), 1e-3)

    def step(self, inputs: Inputs) -> ActuatorStep:
        """Advance by one tick."""
        dt_s = inputs.dt_s
        if inputs.limit_ratio < 1.0:
            self._w *= inputs.limit_ratio
        self._filter.follow_radius(self._own.radius_m)
        self._filter.push(self._q, self._q, 1)
        omega = np.array([phase.omega_rad_s for phase in self._phases])
        error = inputs.signal - inputs.reference
        if inputs.adapt:
            seen, _ = self._filter.read()
            power = seen.real**2 + seen.imag**2
            self._size += dt_s * (power - self._size)
            rate = 2.0 * dt_s * np.abs(omega) / (math.tau * self._turns)
            step = rate * error * seen.conj() / np.maximum(self._size, 1.0)
            self._w -= step
        angle = np.array([phase.lead(self._lead_s) for phase in self._phases])
        frequency = np.abs(self._order * omega) / math.tau
        fade = np.clip((FADE_TO_HZ - frequency) / (FADE_TO_HZ - FADE_FROM_HZ), 0.0, 1.0)
        self._q = fade * np.exp(1j * self._order * angle)
        parts = self._w * self._q
        value = float(parts.real.sum())
        return ActuatorStep(value=value, peak_bound=max(abs(value), 1e-9), slew_bound=0.0)
