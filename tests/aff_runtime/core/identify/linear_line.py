"""A roll, its drive, its tension loop and a short web path as one linear system, by scipy."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from aff_runtime.core.identify.phasors import Phasors

CYCLE_S = 0.005
IDLERS = 4


@dataclass(frozen=True, kw_only=True)
class LinearLine:
    """True numbers; springs of equal spans, masses of equal idlers."""

    gain_rad_s: float = 18.0
    corner_rad_s: float = 4.0
    inertia_kg_m2: float = 0.4
    friction_N_m_s: float = 0.02
    radius_m: float = 0.2
    stiffness_N_m: float = 1400.0
    mass_kg: float = 6.0
    masses: tuple[float, ...] = (1.0,) * IDLERS
    """Of the idlers, beside each other."""
    cell_s: float = 0.01
    loop_gain_m_s_N: float = 0.002
    loop_corner_rad_s: float = 3.0
    delay_s: float = 0.03
    as_torque: bool = False
    pulls_back: bool = True

    def _system(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return A, B, C; states: V, speed-loop integral, spans, idler speeds, end, cell, loop.

        Outputs: V, cell reading, V of the end. The end is a driven roller of 15 kg, 20 rad/s.
        """
        n = IDLERS
        V, integral, spans, idlers = 0, 1, slice(2, 3 + n), slice(3 + n, 3 + 2 * n)
        end, end_integral, cell, loop = 3 + 2 * n, 4 + 2 * n, 5 + 2 * n, 6 + 2 * n
        A, B = np.zeros((7 + 2 * n, 7 + 2 * n)), np.zeros((7 + 2 * n, 1))
        span_at, idler_at = list(range(*spans.indices(99))), list(range(*idlers.indices(99)))
        spring = self.stiffness_N_m * (n + 1)
        mass_kg = [self.mass_kg * one / sum(self.masses) for one in self.masses]
        K, c = self.gain_rad_s, self.corner_rad_s
        # the speed loop's error: U + tension loop - V
        error = np.zeros(7 + 2 * n)
        error[V], error[cell], error[loop] = -1.0, self.loop_gain_m_s_N, 1.0
        A[integral] = error
        A[V] = K * error
        A[V, integral] += K * c
        A[V, V] -= self.friction_N_m_s / self.inertia_kg_m2
        A[V, span_at[0]] += self.radius_m**2 / self.inertia_kg_m2
        B[V] = K
        if not self.as_torque:
            B[integral] = 1.0
        bodies = [V, *idler_at, end]
        for k, span in enumerate(span_at):
            A[span, bodies[k + 1]], A[span, bodies[k]] = spring, -spring
        for k, idler in enumerate(idler_at):
            A[idler, span_at[k + 1]], A[idler, span_at[k]] = 1.0 / mass_kg[k], -1.0 / mass_kg[k]
        A[end, span_at[-1]] = -1.0 / 15.0
        A[end, end], A[end, end_integral], A[end_integral, end] = -20.0, -20.0 * 4.0, 1.0
        A[cell, span_at[-1]] = A[cell, span_at[-2]] = 0.5 / self.cell_s
        A[cell, cell] = -1.0 / self.cell_s
        A[loop, cell] = self.loop_gain_m_s_N * self.loop_corner_rad_s
        C = np.zeros((3, 7 + 2 * n))
        C[0, V] = C[2, end] = 1.0
        C[1, cell] = 1.0 if self.pulls_back else -1.0
        return A, B, C

    def phasors(self, tones_Hz: np.ndarray, noise: float, seed: int = 1) -> Phasors:
        """Return what a probe with tones of 1 mm/s would see.

        Parameters
        ----------
        noise : standard error of every phasor over the median size of its signal.
        """
        A, B, C = self._system()
        omega = math.tau * tones_Hz
        unit = np.eye(len(A))
        answers = [C @ linalg.solve(1j * w * unit - A, B)[:, 0] for w in omega]
        held = np.sinc(omega * CYCLE_S / math.tau) * np.exp(-0.5j * omega * CYCLE_S)
        sent = np.full(omega.size, 1e-3)
        late = held * np.exp(-1j * omega * self.delay_s)
        exact = np.array(answers) * (sent * late)[:, None]
        spread = noise * np.median(np.abs(exact), axis=0)
        rng = np.random.default_rng(seed)
        dice = rng.standard_normal((2, *exact.shape)) / math.sqrt(2.0)
        return Phasors(
            omega_rad_s=omega,
            sent=sent,
            seen=exact + spread * (dice[0] + 1j * dice[1]),
            noise=np.tile(np.diag(spread**2).astype(complex), (omega.size, 1, 1)),
        )
