"""Is a shape from elsewhere that of the roll that turns now? Asked before anything goes out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Complexes = npt.NDArray[np.complex128]
Floats = npt.NDArray[np.float64]
TURNS = 3.0  # of every roll, that a trial takes
ANGLES = 720  # tried around the turn
AGREES = 0.8  # agreement, at least, of a shape as it is
AGREES_TURNED = 0.9  # agreement, at least, of a turned shape
ORDERS_TO_TURN = 3  # above the noise, at least, for a shape to be turned
SIGMAS = 4.0  # of the noise of an order: what is larger is above it
SIZE_RANGE = (0.4, 2.5)  # ripple seen over ripple expected


@dataclass(frozen=True, slots=True, kw_only=True)
class Fit:
    """How a known shape of one roll agrees with the ripple that is there.

    Attributes
    ----------
    agreement : -1..1, cosine between expected and seen ripple at ``turned_rad``; NaN: neither
        the shape nor the roll makes any ripple to speak of.
    turned_rad : angle by which the encoder's origin has moved; 0 where the shape fits as it is.
    ratio : size of the seen ripple over the expected one.
    fits : whether to start from it.
    """

    agreement: float
    turned_rad: float
    ratio: float
    fits: bool


class ShapeTrial:
    """Compares A_n = -(1 + d_n) W_n |phi_n|, the ripple that a shape makes, with the signal's.

    Runs while the line runs and nothing goes out. The signal's order n, M_n, is a lock-in on
    phi_n = P[b_n] over whole turns. Where three orders or more are above the noise the encoder's
    origin may have moved: all angles are tried, W_n e^{-j n angle}.
    """

    def __init__(self, roll_of: Sequence[str], order: Sequence[int], signal_sd: float) -> None:
        self._roll_of = np.array(roll_of)
        self._order = np.array(order, dtype=np.float64)
        self._signal_sd = signal_sd
        self._sum = np.zeros(len(roll_of), dtype=np.complex128)
        self._size = np.zeros(len(roll_of))
        self._turns = np.zeros(len(roll_of))
        self._samples = 0
        self._mean = 0.0
        self._carriers = np.zeros(len(roll_of), dtype=np.complex128)

    def step(self, error: float, phi: Complexes, turn_s: Floats, dt_s: float) -> None:
        """Take one good sample."""
        size = np.abs(phi)
        carrier = phi / np.maximum(size, 1e-12)
        self._samples += 1
        self._sum += error * carrier.conj()
        self._carriers += carrier.conj()
        self._mean += error
        self._size += size
        self._turns += dt_s / turn_s

    @property
    def done(self) -> bool:
        """Whether every roll has turned often enough."""
        return bool(self._samples > 0 and self._turns.min() >= TURNS)

    def fit(self, roll: str, weight_m: Complexes, ratio_less_1: Complexes) -> Fit:
        """Return how the shape of one roll fits; entries of other rolls are not looked at."""
        mine = self._roll_of == roll
        seen = 2.0 / self._samples * (self._sum - self._mean / self._samples * self._carriers)
        expected = -(1.0 + ratio_less_1) * weight_m * (self._size / self._samples)
        noise = self._signal_sd * math.sqrt(2.0 / self._samples)
        loud = mine & ((np.abs(expected) > SIGMAS * noise) | (np.abs(seen) > SIGMAS * noise))
        if not loud.any():
            return Fit(agreement=math.nan, turned_rad=0.0, ratio=1.0, fits=bool(mine.any()))
        a, m, n = expected[loud], seen[loud], self._order[loud]
        size = float(np.linalg.norm(a) * np.linalg.norm(m))
        ratio = float(np.linalg.norm(m)) / max(float(np.linalg.norm(a)), 1e-12)
        angles = np.linspace(-math.pi, math.pi, ANGLES, endpoint=False)
        turned = np.exp(1j * np.outer(angles, n)) @ (a.conj() * m)
        at = int(np.argmax(turned.real))
        straight = float((a.conj() @ m).real) / max(size, 1e-12)
        best = float(turned[at].real) / max(size, 1e-12)
        sized = SIZE_RANGE[0] <= ratio <= SIZE_RANGE[1]
        if straight >= AGREES or n.size < ORDERS_TO_TURN or best < AGREES_TURNED:
            return Fit(
                agreement=straight, turned_rad=0.0, ratio=ratio, fits=sized and straight >= AGREES
            )
        return Fit(agreement=best, turned_rad=float(angles[at]), ratio=ratio, fits=sized)
