"""The source's adaptive feed-forward laws, for experiments on the simulated line."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from sim_plant.reproduce.plant_response import PlantResponse

AMPLITUDE_LIMIT_M_S = 0.2
"""Clamp on every harmonic; on a machine the web is lost before."""


@dataclass(slots=True, kw_only=True)
class PrintedAff:
    """(5.8), (5.10), (5.13), (5.14): theta_1' = g1 e sin, theta_2' = g1 e cos, no phase shift.

    One law for all four: what ``error`` is and where the output goes is the caller's choice.
    ``gain`` carries the sign: printed positive everywhere, right only where Re P < 0.
    ``limit`` is in the unit of the output.
    """

    orders: Sequence[int]
    gain: float
    limit: float = AMPLITUDE_LIMIT_M_S
    weights: list[complex] = field(default_factory=list)

    def step(self, error: float, psi_rad: float, dt_s: float) -> float:
        """Adapt for one sample on ``error`` at roll angle ``psi_rad``; return the output."""
        if not self.weights:
            self.weights = [0j] * len(self.orders)
        output = 0.0
        for k, order in enumerate(self.orders):
            sine, cosine = math.sin(order * psi_rad), math.cos(order * psi_rad)
            grown = self.weights[k] + self.gain * error * dt_s * complex(sine, cosine)
            size = abs(grown)
            self.weights[k] = grown if size <= self.limit else grown * (self.limit / size)
            output -= self.weights[k].real * sine + self.weights[k].imag * cosine
        return output


@dataclass(slots=True, kw_only=True)
class PhasedAff:
    """(5.7) with phi = arg P measured, every order divided by |P|: what the product runs.

    W' = 2 rate e exp(-j psi) / P(n f), output Re W exp(j psi): with y = d + P W the error of W
    decays with the same time constant 1/rate for every order, web and speed, and the sign of P
    needs no choosing (corrects the signs of 5.8-5.14).
    """

    orders: Sequence[int]
    rate_1_s: float
    response: PlantResponse
    limit: float = AMPLITUDE_LIMIT_M_S
    weights: list[complex] = field(default_factory=list)
    _last: float = math.nan

    def step(self, error: float, psi_rad: float, dt_s: float) -> float:
        """Adapt for one sample on ``error`` at roll angle ``psi_rad``; return the output."""
        if not self.weights:
            self.weights = [0j] * len(self.orders)
        turn_Hz = 0.0 if math.isnan(self._last) else (psi_rad - self._last) / dt_s / math.tau
        self._last = psi_rad
        output = 0.0
        for k, order in enumerate(self.orders):
            wave = cmath.exp(1j * order * psi_rad)
            if turn_Hz > 0.0:
                plant = self.response.at(order * turn_Hz)
                grown = self.weights[k] + 2.0 * self.rate_1_s * error * dt_s / (wave * plant)
                size = abs(grown)
                self.weights[k] = grown if size <= self.limit else grown * (self.limit / size)
            output += (self.weights[k] * wave).real
        return output
