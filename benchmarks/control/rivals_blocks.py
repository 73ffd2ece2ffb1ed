"""Blocks on the roll angle: without any phase, and a resonant bank with P's phase and gain."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from aff_runtime.base.signals import ActuatorStep
from aff_runtime.core.impulse import LoopModel
from aff_runtime.core.law import Inputs
from aff_runtime.core.phase import RollPhase
from benchmarks.control.rivals_filtered import Rival

REFRESH_TICKS = 20
MIN_GAIN = 5.0


class AngleBlocks(Rival):
    """w_n' = g e e^{-j n theta} / (-1): (5.14) on the encoder's angle, P's phase ignored.

    With ``loop`` given it is a resonant bank: the phase of P turned back, its gain divided out.
    ``rate_1_s`` is the decay rate where P is known; without P the gain is g1 in m/s per N s.
    """

    def __init__(
        self,
        phases: Mapping[str, RollPhase],
        cycle_s: float,
        *,
        orders: int,
        gain: float,
        loop: LoopModel | None = None,
        f_max_Hz: float = 14.0,
    ) -> None:
        self._phase = phases["unwind"]
        self._cycle_s = cycle_s
        self._order = np.arange(1.0, orders + 1.0)
        self._gain = gain
        self._loop = loop
        self._f_max_Hz = f_max_Hz
        self._w = np.zeros(orders, dtype=np.complex128)
        self._rate = np.zeros(orders, dtype=np.complex128)
        self._ticks = 0

    def step(self, inputs: Inputs) -> ActuatorStep:
        """Advance by one tick."""
        if inputs.limit_ratio < 1.0:
            self._w *= inputs.limit_ratio
        if self._ticks % REFRESH_TICKS == 0:
            self._refresh()
        self._ticks += 1
        ahead_s = 1.5 * self._cycle_s
        carrier = np.exp(1j * self._order * self._phase.theta_rad)
        error = inputs.reference - inputs.signal
        if inputs.adapt:
            self._w += inputs.dt_s * error * self._rate * carrier.conj()
        sent = (
            carrier if self._loop is None else np.exp(1j * self._order * self._phase.lead(ahead_s))
        )
        value = float((self._w * sent).real.sum())
        return ActuatorStep(value=value, peak_bound=max(abs(value), 1e-9), slew_bound=0.0)

    def _refresh(self) -> None:
        frequency = self._order * abs(self._phase.omega_rad_s) / math.tau
        if self._loop is None:
            # tension over unwind speed is negative, so (5.14) adds with g1 > 0: w = -theta_2 + ...
            self._rate = np.full(self._order.size, -self._gain, dtype=np.complex128)
        else:
            ahead = np.exp(1j * math.tau * frequency * 1.5 * self._cycle_s)
            p = np.array(
                [
                    self._loop.response(float(f), self._cycle_s, self._phase.radius_m)
                    for f in frequency
                ]
            )
            drive = p * ahead
            size = np.maximum(np.abs(drive), MIN_GAIN)
            self._rate = 2.0 * self._gain * drive.conj() / size**2
        self._rate[frequency > self._f_max_Hz] = 0.0
        self._w[frequency > self._f_max_Hz] = 0.0
