"""Before and after, order by order, on the plant's true tension."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.order_tracking import order_amplitudes, reduction_dB

TARGET_UNWIND_DB = 30.0
TARGET_FOLLOWER_DB = 20.0
TARGET_FAST_DB = 20.0
FAST_TO_HZ = 60.0
TARGET_RIPPLE = 0.10


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderReduction:
    """One order of one roll in one tension."""

    tension: str
    roll: str
    order: int
    frequency_Hz: float
    before_N: float
    after_N: float
    floor_N: float  # what averaging the load cell's noise over the window leaves
    target_dB: float

    @property
    def reduction_dB(self) -> float:
        """Ripple before over after."""
        return reduction_dB(self.before_N, self.after_N)

    @property
    def at_floor(self) -> bool:
        """Whether the ripple left is no larger than what sensor noise alone explains."""
        return self.after_N <= self.floor_N

    @property
    def passed(self) -> bool:
        """Whether the target is met."""
        return self.reduction_dB >= self.target_dB or self.at_floor


def window(record: dict[str, Array], start_s: float, end_s: float) -> dict[str, Array]:
    """Return the rows with start_s <= time_s < end_s."""
    keep = (record["time_s"] >= start_s) & (record["time_s"] < end_s)
    return {name: values[keep] for name, values in record.items()}


def evaluate(
    before: dict[str, Array], after: dict[str, Array], noise_N: float, *, fast: bool = False
) -> list[OrderReduction]:
    """Return the table: unwind 1x-4x in the unwind tension, follower 1x in the pull-roll tension.

    On a fast line every order of the unwind below 60 Hz, to 20 dB.
    ``noise_N`` is the load cell's noise per sample; the floor of one order is three standard
    deviations of its least-squares amplitude, 3 noise sqrt(2 / samples).
    """
    orders_of: tuple[int, ...] = (1, 2, 3, 4)
    if fast:
        orders_of = tuple(range(1, int(FAST_TO_HZ / turn_Hz(after, "unwind")) + 1))
    target_dB = TARGET_FAST_DB if fast else TARGET_UNWIND_DB
    cases = [
        ("unwind_tension_N", "unwind", orders_of, "swrap_follower", target_dB),
        ("pullroll_tension_N", "swrap_follower", (1,), "unwind", TARGET_FOLLOWER_DB),
    ]
    rows = []
    for tension, roll, orders, other, target in cases:
        amplitudes = [_orders(part, tension, roll, orders, other) for part in (before, after)]
        turning_Hz = turn_Hz(after, roll)
        floor = 3.0 * noise_N * float(np.sqrt(2.0 / after["time_s"].size))
        for number, order in enumerate(orders):
            rows.append(
                OrderReduction(
                    tension=tension,
                    roll=roll,
                    order=order,
                    frequency_Hz=order * turning_Hz,
                    before_N=float(amplitudes[0][number]),
                    after_N=float(amplitudes[1][number]),
                    floor_N=floor,
                    target_dB=target,
                )
            )
    return rows


def turn_Hz(part: dict[str, Array], roll: str) -> float:
    """Return how often a roll turns in a window, on the average."""
    angle, time = part[f"true_{roll}_angle_rad"], part["time_s"]
    return float((angle[-1] - angle[0]) / (time[-1] - time[0]) / (2.0 * np.pi))


def ripple_ratio(before: dict[str, Array], after: dict[str, Array]) -> float:
    """Return the ripple of the true unwind tension after over before."""
    name = "true_unwind_tension_N"
    return float(np.std(after[name]) / np.std(before[name]))


def more_orders(
    before: dict[str, Array], after: dict[str, Array], highest: int, noise_N: float, *, judged: int
) -> list[OrderReduction]:
    """Return the unwind's orders above those that are ``judged``, for eyes; ``target_dB`` 0."""
    tension, roll, other = "unwind_tension_N", "unwind", "swrap_follower"
    orders = tuple(range(judged + 1, highest + 1))
    if not orders:
        return []
    amplitudes = [_orders(part, tension, roll, orders, other) for part in (before, after)]
    turning_Hz = turn_Hz(after, roll)
    return [
        OrderReduction(
            tension=tension,
            roll=roll,
            order=order,
            frequency_Hz=order * turning_Hz,
            before_N=float(b),
            after_N=float(a),
            target_dB=0.0,
            floor_N=3.0 * noise_N * float(np.sqrt(2.0 / after["time_s"].size)),
        )
        for order, b, a in zip(orders, *amplitudes, strict=True)
    ]


def _orders(
    part: dict[str, Array], tension: str, roll: str, orders: tuple[int, ...], other: str
) -> Array:
    return np.abs(
        order_amplitudes(
            part[f"true_{tension}"],
            part[f"true_{roll}_angle_rad"],
            orders,
            {other: part[f"true_{other}_angle_rad"]},
        )
    )


def table_text(rows: list[OrderReduction]) -> str:
    """Return the before/after table for a terminal."""
    lines = [
        f"{'tension':20s} {'roll':15s} {'order':>5s} {'Hz':>6s} {'before N':>9s} "
        f"{'after N':>9s} {'dB':>6s} {'floor N':>8s}  verdict"
    ]
    for row in rows:
        verdict = "ok" if row.passed else f"below {row.target_dB:.0f} dB"
        if row.passed and row.reduction_dB < row.target_dB:
            verdict = "ok (at the noise floor)"
        lines.append(
            f"{row.tension:20s} {row.roll:15s} {row.order:>4d}x {row.frequency_Hz:6.3f} "
            f"{row.before_N:9.4f} {row.after_N:9.4f} {row.reduction_dB:6.1f} {row.floor_N:8.4f}"
            f"  {verdict}"
        )
    return "\n".join(lines)
