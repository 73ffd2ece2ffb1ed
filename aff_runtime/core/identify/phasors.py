"""Complex amplitudes of several signals at a probe's tones, and the noise that they share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aff_runtime.base.errors import RefusedError
from aff_runtime.core.identify.regression import SIDES, Regression

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
TREND_TO = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class Phasors:
    """One row per tone, rising in frequency.

    Attributes
    ----------
    omega_rad_s : (tones,).
    sent : (tones,) amplitude of the correction; its phase is the origin of all others.
    seen : (tones, signals).
    noise : (tones, signals, signals) covariance E[n n^H] of ``seen``.
    """

    omega_rad_s: Floats
    sent: Floats
    seen: Complexes
    noise: Complexes

    def below(self, frequency_Hz: float) -> Phasors:
        """Return the tones up to a frequency."""
        return self.only(self.omega_rad_s <= math.tau * frequency_Hz)

    def only(self, kept: npt.NDArray[np.bool_]) -> Phasors:
        """Return some of the tones."""
        return Phasors(
            omega_rad_s=self.omega_rad_s[kept],
            sent=self.sent[kept],
            seen=self.seen[kept],
            noise=self.noise[kept],
        )

    def scaled(self, factors: Sequence[float], rates: Sequence[int]) -> Phasors:
        """Return every signal times its factor, differentiated ``rates`` times."""
        turn = 1j * self.omega_rad_s[:, None]
        by = np.asarray(factors) * turn ** np.asarray(rates)[None, :]
        return Phasors(
            omega_rad_s=self.omega_rad_s,
            sent=self.sent,
            seen=self.seen * by,
            noise=self.noise * by[:, :, None] * by.conj()[:, None, :],
        )


def read_phasors(
    time_s: Floats,
    signals: Floats,
    design: Floats,
    tones: Sequence[tuple[float, float, float]],
    first: int,
) -> Phasors:
    """Return every signal's complex amplitude at every tone.

    The regression's columns are those of the response's own fit (tones, ripple of the rolls,
    strange ripple, drift) and a trend of higher degree: an angle grows, and its roll shrinks.

    Parameters
    ----------
    signals : (samples, signals).
    design : (samples, columns); columns ``first`` and ``first + 1`` are cos and -sin of tone 0.
    tones : omega (rad/s), phase and amplitude of each.
    """
    span_s = float(time_s[-1] - time_s[0])
    drift = 2.0 * (time_s - 0.5 * (time_s[0] + time_s[-1])) / span_s
    higher = [drift**k for k in range(3, TREND_TO)]
    regression = Regression(time_s, np.column_stack([design, *higher]))
    solution, residual = regression.solve(signals)
    rows = []
    for k, (omega, _, amplitude) in enumerate(tones):
        at = first + 2 * k
        seen = solution[at] + 1j * solution[at + 1]
        noise, places = regression.noise(residual, omega, at)
        if places < SIDES // 2:
            raise RefusedError(
                f"the tones stand too close to tell their noise: beside {omega / math.tau:.2f} Hz "
                f"from {places} places, {SIDES // 2} are needed; raise probe.duration_s"
            )
        rows.append((omega, amplitude, seen, noise))
    rows.sort(key=lambda row: row[0])
    omegas, sent, seen_rows, noises = zip(*rows, strict=True)
    return Phasors(
        omega_rad_s=np.array(omegas),
        sent=np.array(sent),
        seen=np.array(seen_rows),
        noise=np.array(noises),
    )
