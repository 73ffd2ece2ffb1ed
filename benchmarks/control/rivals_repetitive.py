"""Plug-in repetitive control on the roll's angle, with the inverse of P per order."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from aff_runtime.base.signals import ActuatorStep
from aff_runtime.core.impulse import LoopModel
from aff_runtime.core.law import Inputs
from aff_runtime.core.phase import RollPhase
from benchmarks.control.rivals_filtered import Rival


class Repetitive(Rival):
    """Once per turn: u(angle) <- Q [u - gain P^-1 e(angle)], all in the angle domain.

    The error of one turn is averaged into bins, taken to orders, divided by P at the frequency
    each order has now (regularised), low-passed by Q, and added to the table. What a user of
    iterative learning would build on an encoder, with the inverse the crude lead lacks.
    """

    def __init__(
        self,
        phases: Mapping[str, RollPhase],
        cycle_s: float,
        loop: LoopModel,
        *,
        gain: float,
        q_Hz: float,
        bins: int = 48,
    ) -> None:
        self._bins = bins
        self._phase = phases["unwind"]
        self._loop = loop
        self._cycle_s = cycle_s
        self._gain = gain
        self._q_Hz = q_Hz
        self._table = np.zeros(bins // 2 + 1, dtype=np.complex128)
        self._sum = np.zeros(bins)
        self._hits = np.zeros(bins)
        self._order = np.arange(bins // 2 + 1)
        self._turn = -1
        self._good = False

    def step(self, inputs: Inputs) -> ActuatorStep:
        """Advance by one tick."""
        if inputs.limit_ratio < 1.0:
            self._table *= inputs.limit_ratio
        theta = self._phase.theta_rad
        turn = math.floor(theta / math.tau)
        if turn != self._turn:
            if self._good and inputs.adapt and self._hits.min() > 0:
                self._learn()
            self._turn = turn
            self._sum[:] = 0.0
            self._hits[:] = 0.0
            self._good = inputs.adapt
        at = int((theta / math.tau - turn) * self._bins) % self._bins
        self._sum[at] += inputs.signal - inputs.reference
        self._hits[at] += 1.0
        ahead = self._phase.lead(1.5 * self._cycle_s)
        wave = np.exp(1j * self._order * ahead)
        value = float((self._table * wave).real.sum())
        return ActuatorStep(value=value, peak_bound=max(abs(value), 1e-9), slew_bound=0.0)

    def _learn(self) -> None:
        spectrum = np.fft.rfft(self._sum / self._hits) * (2.0 / self._bins)
        turn_Hz = abs(self._phase.omega_rad_s) / math.tau
        middle = np.exp(-1j * self._order * math.pi / self._bins)
        for n in range(1, self._order.size):
            frequency_Hz = n * turn_Hz
            if frequency_Hz > 1.5 * self._q_Hz:
                self._table[n] = 0.0
                continue
            turned = np.exp(1j * n * self._phase.omega_rad_s * 1.5 * self._cycle_s)
            p = self._loop.response(frequency_Hz, self._cycle_s, self._phase.radius_m)
            drive = p * turned
            inverse = drive.conjugate() / (abs(drive) ** 2 + 25.0)
            keep = 1.0 / (1.0 + (frequency_Hz / self._q_Hz) ** 8)
            error = spectrum[n] * middle[n]
            self._table[n] = keep * (self._table[n] - self._gain * error * inverse)
