"""The waveform that fits under a limit: nearest to the wish in what the signal feels."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from aff_runtime.core.shape.bounds import POINTS_PER_ORDER

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
STIFFNESS = 2.0  # of the bounds' penalty, over the geometric mean of 2 q_n
RETURN = 0.1  # of what is missing, per step, where nothing binds
LEAST = 1e-6  # of the largest: smaller c_n do not set the penalty, smaller q_n count as this


class WaveFit:
    r"""Finds the coefficients x_n that a limit leaves of a wish c_n, one step per tick.

    Over the turn of a roll the output is Re sum_n x_n e^{j n a}. Wanted is

        least sum_n q_n |c_n - x_n|^2   with   |Re sum x_n e^{j n a}| <= limit,
        |Re sum j n x_n e^{j n a}| <= slew limit per radian, at every sampled a,
        and |c_n - x_n| <= |c_n|,

    q_n = |P_n|^2: the least ripple that the limits let reach, with no order above what it has
    without any correction. The problem is convex, so there is one answer; it moves with the wish
    and never jumps. Solved by the alternating direction method of multipliers
    [Boyd et al. 2011]: orders are orthogonal over evenly spread angles, so each of its steps is
    two products with one matrix and a clip. It goes on where the last tick left it.

    Attributes
    ----------
    orders : different orders of the roll, (m,).
    price : multipliers of value and slope, (2, points): by how much the squared ripple falls per
        unit of more room at that angle; zero where nothing binds. The slope counts in units of
        the highest order.
    """

    __slots__ = ("_bend", "_highest", "_pair", "_waves", "orders", "price")

    def __init__(self, orders: Floats) -> None:
        self.orders = orders
        self._highest = float(orders.max(initial=1.0))
        points = POINTS_PER_ORDER * int(self._highest)
        angle = np.arange(points) * (math.tau / points)
        # Re (x e^{j a}) = re x cos a - im x sin a, for x as pairs of reals
        self._waves = np.exp(-1j * np.outer(angle, orders)).view(np.float64)
        self._bend = orders / self._highest
        self._pair = np.zeros((2, orders.size), dtype=np.complex128)
        self.price = np.zeros((2, points))

    def step(
        self, x: Complexes, wish: Complexes, worth: Floats, limit: float, slew_per_rad: float
    ) -> Complexes:
        """Return x one step nearer to what fits.

        Parameters
        ----------
        x, wish : where the last step ended, c_n; output units, (m,).
        worth : q_n, squared signal per squared output, (m,).
        limit, slew_per_rad : not negative; the latter may be inf.
        """
        own = np.abs(wish)
        wanted = own > LEAST * own.max(initial=0.0)
        most = float(worth[wanted].max(initial=0.0))
        if not most > 0.0:
            self.price[:] = 0.0
            return wish
        q = 2.0 * np.clip(worth, LEAST * most, most)
        points = self.price.shape[1]
        bend = self._bend
        pull = STIFFNESS * math.exp(float(np.log(q[wanted]).mean()))
        top = np.array([[limit], [slew_per_rad / self._highest]])
        np.stack((x, 1j * bend * x), out=self._pair)
        reached = self._pair.view(np.float64) @ self._waves.T
        reached += self.price * (0.5 * points / pull)
        within = np.minimum(np.maximum(reached, -top), top)
        reached -= within
        np.multiply(reached, 2.0 * pull / points, out=self.price)
        if not self.price.any():
            return np.asarray(x + RETURN * (wish - x))
        within -= reached
        back = (within @ self._waves).view(np.complex128) * (2.0 / points)
        found = q * wish + pull * (back[0] - 1j * bend * back[1])
        found /= q + pull * (1.0 + bend * bend)
        found -= wish
        found *= own / np.maximum(np.abs(found), np.maximum(own, 1e-300))
        return np.asarray(wish + found)

    def prices(self) -> tuple[float, float]:
        """Return the price of the limit and of the slew limit per radian, summed over the turn."""
        sums = np.abs(self.price).sum(axis=1)
        return float(sums[0]), float(sums[1]) / self._highest

    def adopt(self, old: WaveFit) -> None:
        """Go on with the prices of ``old``, each at the nearest angle of one's own."""
        points, was = self.price.shape[1], old.price.shape[1]
        nearest = np.rint(np.arange(was) * (points / was)).astype(np.int64) % points
        self.price[:] = 0.0
        for mine, theirs in zip(self.price, old.price, strict=True):
            np.add.at(mine, nearest, theirs)
        self.price[1] *= self._highest / old._highest
