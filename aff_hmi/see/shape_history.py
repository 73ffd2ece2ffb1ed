"""How shapes moved while this screen looked on: their scatter, their growth, other rolls."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from aff_hmi.layout import label_of
from aff_hmi.notices import place_key
from aff_hmi.see.rolls_part import STEP_DEG, degrees_of, of_rolls, weights_mm
from aff_hmi.see.trend_rows import MEAN, MINUTE_S, coarser
from aff_hmi.see.trends import FINE, Trends
from aff_hmi.watch import Observed
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.signals import State

TURNS, FEWEST = 20, 10  # over which a shape scatters; before it is told
FEWEST_MIN, TIMES_SCATTER = 20, 4.0
GROWTH_S = 30.0  # for which an answer holds
ANGLES_RAD = np.radians(np.arange(0, 360, STEP_DEG))


class _Turns:
    """The shape of one roll, once a turn: (order, amplitude in mm) of every order."""

    def __init__(self) -> None:
        self.since = 0.0
        self.orders: tuple[int, ...] = ()
        self.weights: deque[tuple[complex, ...]] = deque(maxlen=TURNS)

    def add(self, found: list[tuple[int, complex]]) -> None:
        """Keep one turn; other orders begin anew."""
        orders = tuple(order for order, _ in found)
        if orders != self.orders:
            self.orders = orders
            self.weights.clear()
        self.weights.append(tuple(weight for _, weight in found))


class ShapeHistory:
    """Follows the shapes of one line.

    Parameters
    ----------
    trends : what is kept of the size of every order. ``wall`` : returns wall time, s since 1970.
    """

    def __init__(self, trends: Trends, wall: Callable[[], float]) -> None:
        self._trends = trends
        self._wall = wall
        self._turns: dict[str, _Turns] = {}
        self._start_ns = -1
        self._time_s = math.nan
        self._roll_id = math.nan
        self._since = (math.nan, math.nan)
        self._growing: set[tuple[str, str]] = set()
        self._grown_s = -math.inf

    @property
    def roll_since(self) -> tuple[float, float]:
        """Number of the roll that came last, and wall time since when; NaN for none."""
        return self._since

    def look(self, seen: Observed) -> None:
        """Take note of a moment: of every roll once a turn, while the correction goes out."""
        site = seen.site
        row, meta = seen.row, seen.meta
        if site is None or row is None or not seen.writer_lives:
            return
        start_ns = meta.start_ns if meta is not None else 0
        passed_s = row.time_s - self._time_s
        self._time_s = row.time_s
        self._note_roll(row.number("roll_id"))
        if start_ns != self._start_ns or not passed_s >= 0.0 or row.state is not State.ACTIVE:
            self._start_ns = start_ns  # angles count anew, or nothing is learned
            self._turns.clear()
            return
        for (actuator, roll), (facts, orders) in of_rolls(row, site).items():
            turns = self._turns.setdefault(place_key(actuator, roll), _Turns())
            turns.since += _turns_in(row, roll, passed_s)
            if turns.since >= 1.0:
                turns.since %= 1.0
                degrees, _ = degrees_of(row, facts, orders)
                turns.add(weights_mm([(o, degrees[o.name]) for o in orders]))

    def scatter_mm(self, key: str) -> tuple[float, ...]:
        """Return twice the standard deviation of an outline over its last turns, mm.

        It says how far the learned shape moves, and no more: an error that stays is not in it.
        Empty before ``FEWEST`` turns, and where nothing moves, as nothing is learned then.
        """
        turns = self._turns.get(key)
        if turns is None or len(turns.weights) < FEWEST or len(set(turns.weights)) == 1:
            return ()
        weights = np.array(turns.weights)
        basis = np.exp(1j * np.outer(turns.orders, ANGLES_RAD))
        twice: NDArray[np.float64] = 2.0 * (weights @ basis).real.std(axis=0, ddof=1)
        return tuple(float(f"{mm:.2g}") for mm in twice)

    def grows(self, actuator: str, order: str) -> bool:
        """Return whether an order has grown over the last hour by four times its scatter.

        A straight line through the means of the minutes, of 20 or more, rises from end to end by
        more than four times the standard deviation about it. Learning after an arm is no straight
        line, and is told apart by that.
        """
        now_s = self._wall()
        if not 0.0 <= now_s - self._grown_s < GROWTH_S:
            self._grown_s = now_s
            self._growing = self._grown()
        return (f"mm {label_of(actuator)}", label_of(order)) in self._growing

    def _grown(self) -> set[tuple[str, str]]:
        curves = [one for one in self._trends.series if one.group.startswith("mm ")]
        minutes = coarser(self._trends.seconds(curves, FINE), MINUTE_S)
        return {
            (one.group, one.label)
            for n, one in enumerate(curves)
            if _is_growing(minutes.t_s, minutes.bins[:, MEAN, n])
        }

    def _note_roll(self, roll_id: float) -> None:
        if not math.isfinite(roll_id):
            return
        if math.isfinite(self._roll_id) and roll_id != self._roll_id:
            self._since = (roll_id, self._wall())
            self._turns.clear()
        self._roll_id = roll_id


def _turns_in(row: TickRow, roll: str, passed_s: float) -> float:
    turns = abs(row.roll(roll).omega_rad_s) * passed_s / math.tau
    return turns if math.isfinite(turns) else 0.0


def _is_growing(t_s: NDArray[np.int64], means: NDArray[np.floating]) -> bool:
    known = np.isfinite(means)
    if int(known.sum()) < FEWEST_MIN:
        return False
    time, size = (t_s[known] - t_s[0]).astype(float), means[known].astype(float)
    slope, offset = np.polyfit(time, size, 1)
    about = float(np.std(size - (slope * time + offset), ddof=2))
    return bool(slope * (time[-1] - time[0]) > TIMES_SCATTER * about and slope > 0.0)
