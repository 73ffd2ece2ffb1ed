"""What a limit leaves of a waveform, against an independent solver and against the conditions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import minimize

from aff_runtime.core.shape.allocation import Headroom, OutputAllocation
from aff_runtime.core.shape.bounds import PeakBound
from aff_runtime.core.shape.columns import ColumnState
from aff_runtime.core.shape.fitting import WaveFit
from aff_runtime.core.shape.wish import Wish
from tests.aff_runtime.core.plants import CYCLE_S

ORDERS = np.arange(1.0, 6.0)
WISH = np.array([10e-3, 9e-3j, -8e-3, 7e-3 + 3e-3j, 6e-3])
GAIN = np.array([150.0, 100.0, 80.0, 30.0, 10.0])
ANGLES = np.linspace(0.0, math.tau, 80, endpoint=False)  # as the fit samples five orders
TURNED = np.exp(1j * np.outer(ANGLES, ORDERS))


def value(x: np.ndarray) -> np.ndarray:
    return (TURNED @ x).real


def slope(x: np.ndarray) -> np.ndarray:
    return (TURNED @ (1j * ORDERS * x)).real


def cost(x: np.ndarray) -> float:
    return float((GAIN**2 * np.abs(WISH - x) ** 2).sum())


def fitted(limit: float, slew: float = math.inf, steps: int = 700) -> np.ndarray:
    fit, x = WaveFit(ORDERS), WISH.copy()
    for _ in range(steps):
        x = fit.step(x, WISH, GAIN**2, limit, slew)
    return x


def best(limit: float, slew: float) -> float:
    """Return the least cost by sequential quadratic programming, from scipy."""
    scale = 1e-2

    def pairs(v: np.ndarray) -> np.ndarray:
        return scale * v.view(np.complex128)

    rules = [
        lambda v: (limit - np.abs(value(pairs(v)))) / limit,
        lambda v: (slew - np.abs(slope(pairs(v)))) / slew,
        lambda v: (np.abs(WISH) ** 2 - np.abs(WISH - pairs(v)) ** 2) / scale**2,
    ]
    found = minimize(
        lambda v: cost(pairs(v)),
        0.3 * WISH.view(np.float64) / scale,
        constraints=[{"type": "ineq", "fun": rule} for rule in rules],
        method="SLSQP",
        options={"maxiter": 500, "ftol": 1e-10},
    )
    assert found.success, found.message
    return float(found.fun)


@pytest.mark.parametrize(("of_peak", "of_slew"), [(0.6, 1.2), (1.2, 0.5), (0.7, 0.6), (0.4, 0.9)])
def test_what_fits_leaves_the_least_ripple_there_is(of_peak, of_slew):
    limit, slew = of_peak * np.abs(value(WISH)).max(), of_slew * np.abs(slope(WISH)).max()
    x = fitted(limit, slew)
    assert np.abs(value(x)).max() <= 1.005 * limit
    assert np.abs(slope(x)).max() <= 1.005 * slew
    assert (np.abs(WISH - x) <= np.abs(WISH) * (1 + 1e-9)).all()
    assert cost(x) == pytest.approx(best(limit, slew), rel=0.01)


def test_it_leaves_less_than_dropping_the_costliest_orders_whole():
    limit = 0.6 * np.abs(value(WISH)).max()
    share = np.ones(5)
    for at in np.argsort(GAIN):  # most output per newton first
        steps = [np.where(np.arange(5) == at, s, share) for s in np.linspace(1.0, 0.0, 1001)]
        fits = [s for s in steps if np.abs(value(s * WISH)).max() <= limit]
        share = fits[0] if fits else steps[-1]
        if fits:
            break
    assert cost(fitted(limit)) < 0.5 * cost(share * WISH)


def test_with_room_enough_nothing_is_taken():
    assert fitted(1.001 * np.abs(value(WISH)).max()) == pytest.approx(WISH)


def test_a_limit_of_nothing_leaves_nothing():
    assert np.abs(fitted(0.0)).max() < 1e-3 * np.abs(WISH).max()


class Lines:
    """An allocation on one own roll and perhaps another, with a wish that stands still."""

    def __init__(self, other=()):
        order = np.concatenate([ORDERS, np.ones(len(other))])
        rolls = ["own"] * 5 + ["other"] * len(other)
        self.bounds = PeakBound(order, rolls, "own")
        self.allocation = OutputAllocation(
            ColumnState(order.size), order, rolls, "own", self.bounds
        )
        self.carrier = np.ones(order.size, dtype=np.complex128)
        self.omega = np.full(order.size, 5.0)
        self.wish = Wish(
            parts=np.concatenate([WISH, other]),
            carrier=self.carrier,
            worth=np.concatenate([GAIN, np.full(len(other), 120.0)]) ** 2,
            omega_rad_s=self.omega,
            learning_1_s=0.0,
        )

    def run(self, seconds: float, limit: float) -> np.ndarray:
        """Return every change of the factors, (ticks, columns)."""
        moves = []
        for _ in range(round(seconds / CYCLE_S)):
            before = self.allocation.factor.copy()
            if self.allocation.binds(Headroom(limit, math.inf)):
                self.allocation.step(Headroom(limit, math.inf), self.wish, CYCLE_S)
            moves.append(self.allocation.factor - before)
            sent = self.allocation.factor * self.wish.parts
            peak, slew = self.bounds.of(sent, self.carrier, self.omega)
            self.allocation.peak, self.allocation.slew = peak, slew
        return np.array(moves)


def test_the_output_fits_within_a_second_and_then_stands_still():
    lines = Lines()
    limit = 0.6 * lines.bounds.of(WISH, lines.carrier, lines.omega)[0]
    lines.run(1.0, math.inf)
    assert not lines.allocation.limited
    first = lines.run(1.0, limit)
    assert 0.95 * limit < lines.allocation.peak <= limit
    assert np.abs(first).max() < 0.05  # no bump: a twentieth of an order at most per tick
    assert np.abs(lines.run(3.0, limit)[-100:]).max() < 1e-5  # no chatter


def test_what_was_taken_comes_back_whole_when_the_limit_is_gone():
    lines = Lines()
    limit = 0.4 * lines.bounds.of(WISH, lines.carrier, lines.omega)[0]
    lines.run(4.0, limit)
    assert lines.allocation.share.min() < 0.5
    lines.run(1.0, math.inf)
    assert (lines.allocation.factor == 1.0).all()
    assert not lines.allocation.limited


def test_room_comes_back_from_a_limit_that_took_everything():
    lines = Lines()
    lines.allocation.peak = 1.0
    lines.run(3.0, 0.0)
    assert lines.allocation.share.max() < 0.01
    limit = 0.6 * lines.bounds.of(WISH, lines.carrier, lines.omega)[0]
    lines.run(2.0, limit)
    assert 0.95 * limit < lines.allocation.peak <= limit


def test_a_column_of_another_roll_pays_the_same_price():
    """At the least of q |c - x|^2 + price x of either: what a little more headroom is worth."""
    other = 9e-3
    lines = Lines(other=(other,))
    limit = 0.5 * lines.bounds.of(lines.wish.parts, lines.carrier, lines.omega)[0]
    lines.run(8.0, limit)
    assert 0.95 * limit < lines.allocation.peak <= limit

    def left(headroom: float) -> float:
        return min(
            cost(fitted(max(headroom - x, 0.0), steps=300)) + (120.0 * (other - x)) ** 2
            for x in np.linspace(0.7 * other, other, 7)
        )

    sent = np.abs(lines.allocation.factor[:5] * WISH - WISH)
    mine = float((GAIN**2 * sent**2).sum())
    mine += (120.0 * other * abs(1.0 - lines.allocation.factor[5])) ** 2
    slack = lines.bounds.slack
    assert mine == pytest.approx(left(0.98 * limit / slack + other * (1 - 1 / slack)), rel=0.1)


def test_learning_takes_from_the_slew_that_is_left_but_never_all():
    lines = Lines()
    headroom = Headroom(math.inf, 0.5 * lines.bounds.of(WISH, lines.carrier, lines.omega)[1])
    busy = Wish(
        parts=lines.wish.parts,
        carrier=lines.carrier,
        worth=lines.wish.worth,
        omega_rad_s=lines.omega,
        learning_1_s=10.0 * headroom.slew_limit,
    )
    for _ in range(800):
        lines.allocation.step(headroom, busy, CYCLE_S)
    sent = lines.allocation.factor * WISH
    slew = lines.bounds.of(sent, lines.carrier, lines.omega)[1]
    assert 0.15 * headroom.slew_limit < slew <= 0.21 * headroom.slew_limit
