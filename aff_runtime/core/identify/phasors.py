"""Complex amplitudes of several signals at a probe's tones, and the noise that they share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aff_runtime.base.errors import RefusedError

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
SIDES = 16
"""Places beside a tone that its noise is told from."""
WITHIN = 0.4
"""A place of which the regression leaves less than this tells nothing."""
SEARCHED = (30, 60)
"""Places beside a tone that are looked at, and where too few of them are clear."""
TREND_TO = 6
SPANNED = 1e-10


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
    The noise of a tone is that of the residual beside it: at each place its power over the share
    of that place which the columns leave, times what the regression makes of white noise.

    Parameters
    ----------
    signals : (samples, signals).
    design : (samples, columns); columns ``first`` and ``first + 1`` are cos and -sin of tone 0.
    tones : omega (rad/s), phase and amplitude of each.
    """
    span_s = float(time_s[-1] - time_s[0])
    drift = 2.0 * (time_s - 0.5 * (time_s[0] + time_s[-1])) / span_s
    higher = [drift**k for k in range(3, TREND_TO)]
    columns = np.column_stack([design, *higher])
    power, directions = np.linalg.eigh(columns.T @ columns)
    kept = power > SPANNED * power[-1]
    turn = directions[:, kept] / np.sqrt(power[kept])
    basis = columns @ turn
    share = basis.T @ signals
    solution = turn @ share
    residual = signals - basis @ share
    thin = basis.astype(np.float32)  # shares of power need no more
    rows = []
    for k, (omega, _, amplitude) in enumerate(tones):
        at = first + 2 * k
        seen = solution[at] + 1j * solution[at + 1]
        spread = float((turn[at] ** 2).sum() + (turn[at + 1] ** 2).sum())
        noise = _density(time_s, residual, thin, omega, span_s) * spread
        rows.append((omega, amplitude, seen, noise))
    rows.sort(key=lambda row: row[0])
    omegas, sent, seen_rows, noises = zip(*rows, strict=True)
    return Phasors(
        omega_rad_s=np.array(omegas),
        sent=np.array(sent),
        seen=np.array(seen_rows),
        noise=np.array(noises),
    )


def _density(
    time_s: Floats, residual: Floats, basis: npt.NDArray[np.float32], omega: float, span_s: float
) -> Complexes:
    """Return the covariance of the white noise that would be as large as what is there nearby."""
    for searched in SEARCHED:
        cos, sin, left = _places(time_s, basis, omega, span_s, searched)
        # what the columns leave of a place's own noise, and no other's
        clear = np.flatnonzero(left > WITHIN)[:SIDES]
        if clear.size == SIDES:
            break
    if clear.size < SIDES // 2:
        raise RefusedError("the tones stand too close to tell their noise; probe for longer")
    found = (cos[clear] - 1j * sin[clear]) @ residual
    near = found / np.sqrt(time_s.size * left[clear])[:, None]
    return np.asarray(near.T @ near.conj() / clear.size)


def _places(
    time_s: Floats, basis: npt.NDArray[np.float32], omega: float, span_s: float, searched: int
) -> tuple[Floats, Floats, Floats]:
    """Return cos and sin at places beside a tone, and the share of each that no column holds."""
    steps = np.arange(1, searched + 1)
    aside = 0.25 + 0.5 * ((steps + 1) // 2) * np.where(steps % 2 == 0, -1.0, 1.0)
    places = omega + math.tau * aside / span_s
    places = places[places > 0.0]
    turns = places[:, None] * time_s[None, :]
    cos, sin = np.cos(turns), np.sin(turns)
    held = ((cos.astype(basis.dtype) @ basis) ** 2).sum(axis=1)
    held += ((sin.astype(basis.dtype) @ basis) ** 2).sum(axis=1)
    return cos, sin, 1.0 - held / time_s.size
