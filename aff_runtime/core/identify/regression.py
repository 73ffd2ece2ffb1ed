"""Least squares of columns over time, and the noise that they leave beside a frequency."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
SIDES = 16
"""Places beside a tone that its noise is told from."""
WITHIN = 0.4
"""A place of which the columns leave less than this tells nothing."""
SEARCHED = (30, 60, 240)
"""Places beside a tone that are looked at, and where too few of them are clear."""
SPANNED, LEAST = 1e-10, 1e-3


class Regression:
    """Columns (samples, columns) that several signals over the same time are explained by.

    Parameters
    ----------
    time_s : one entry per sample; samples may be missing.
    """

    def __init__(self, time_s: Floats, columns: Floats) -> None:
        power, directions = np.linalg.eigh(columns.T @ columns)
        kept = power > SPANNED * power[-1]
        self._time_s = time_s
        self._turn = directions[:, kept] / np.sqrt(power[kept])
        self._basis = columns @ self._turn
        self._thin = self._basis.astype(np.float32)  # shares of power need no more
        self._aside: dict[int, tuple[Floats, Complexes]] = {}

    def solve(self, signals: Floats) -> tuple[Floats, Floats]:
        """Return the factors of the columns (columns, signals), and what they leave."""
        share = self._basis.T @ signals
        return self._turn @ share, signals - self._basis @ share

    def noise(self, residual: Floats, omega: float, at: int) -> tuple[Complexes, int]:
        """Return the covariance E[n n^H] of a complex factor, and from how many places it is told.

        The noise is that of the residual beside the frequency: at each place its power over the
        share of that place which the columns leave, times what they make of white noise.

        Parameters
        ----------
        residual : (samples, signals) that ``solve`` left.
        omega, at : of a tone, rad/s; its columns are ``at`` (cos) and ``at`` + 1 (-sin).
        """
        density, places = self._density(residual, omega)
        spread = float((self._turn[at : at + 2] ** 2).sum())
        return density * spread, places

    def _density(self, residual: Floats, omega: float) -> tuple[Complexes, int]:
        """Return the covariance of the white noise that would be as large as what is there."""
        for searched in SEARCHED:
            turns, left = self._places(omega, searched)
            # what the columns leave of a place's own noise, and no other's
            clear = np.flatnonzero(left > WITHIN)[:SIDES]
            if clear.size == SIDES:
                break
        told = clear.size
        if told == 0:  # rather what is told badly than no noise at all
            clear = np.argsort(left)[-SIDES:]
        found = turns[clear].conj() @ residual
        near = found / np.sqrt(self._time_s.size * np.maximum(left[clear], LEAST))[:, None]
        return np.asarray(near.T @ near.conj() / clear.size), int(told)

    def _places(self, omega: float, searched: int) -> tuple[Complexes, Floats]:
        """Return exp(i omega t) of places beside a tone, and the share that no column holds."""
        aside, turned = self._turned(searched)
        above = omega + aside > 0.0
        turns = np.exp(1j * omega * self._time_s) * (turned if above.all() else turned[above])
        held = ((turns.real.astype(self._thin.dtype) @ self._thin) ** 2).sum(axis=1)
        held += ((turns.imag.astype(self._thin.dtype) @ self._thin) ** 2).sum(axis=1)
        return turns, 1.0 - held / self._time_s.size

    def _turned(self, searched: int) -> tuple[Floats, Complexes]:
        """Return how far the places lie beside a tone, rad/s, and what turns a tone there.

        They are the same beside every tone: a product costs a third of a cosine and a sine.
        """
        if searched not in self._aside:
            time_s = self._time_s
            steps = np.arange(1, searched + 1)
            side = 0.25 + 0.5 * ((steps + 1) // 2) * np.where(steps % 2 == 0, -1.0, 1.0)
            aside = np.asarray(math.tau / float(time_s[-1] - time_s[0]) * side, np.float64)
            self._aside[searched] = aside, np.exp(1j * aside[:, None] * time_s[None, :])
        return self._aside[searched]
