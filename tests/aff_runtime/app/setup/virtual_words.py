"""Words of a PLC that follow formulas: each value packed on its own, watched every 20 ms."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from aff_runtime.app.setup.words.reading import Watched

PERIOD_S = 0.02
SPEED_M_S = 1.016
RADIUS_M = 0.1981
FOLLOWER_M = 0.15367


@dataclass(frozen=True)
class Item:
    """One value: its first word, how it is stored, SI in a count, and the value over time."""

    address: int
    type: str
    scale: float
    value: Callable[[float], float]
    order: str = "high_first"

    def words(self, t_s: float) -> dict[int, int]:
        counts = round(self.value(t_s) / self.scale)
        if self.type.endswith("16"):
            return {self.address: counts % 0x10000}
        halves = [counts // 0x10000 % 0x10000, counts % 0x10000]
        if self.order == "low_first":
            halves.reverse()
        return {self.address: halves[0], self.address + 1: halves[1]}


def watched(items: Sequence[Item], seconds: float = 3.0, start_s: float = 0.0) -> Watched:
    """Return what a reader sees of the items from ``start_s`` on."""
    times = [start_s + n * PERIOD_S for n in range(round(seconds / PERIOD_S))]
    words: dict[int, list[int]] = {}
    for t_s in times:
        row: dict[int, int] = {}
        for item in items:
            row.update(item.words(t_s))
        for address, word in row.items():
            words.setdefault(address, []).append(word)
    return Watched(
        times_s=tuple(t - start_s for t in times),
        words={address: tuple(series) for address, series in words.items()},
    )


def still(value: float) -> Callable[[float], float]:
    return lambda _t_s: value


def ripple(mean: float, amplitude: float, frequency_Hz: float = 0.816) -> Callable[[float], float]:
    return lambda t_s: mean + amplitude * math.sin(2.0 * math.pi * frequency_Hz * t_s)


def turning(rate_per_s: float, zero: float = 0.0) -> Callable[[float], float]:
    return lambda t_s: zero + rate_per_s * t_s


def euclid(order: str = "high_first", tension_N: float = 90.0) -> list[Item]:
    """The default block: values as on the Euclid line at 200 FPM."""
    angle = 2.0 * math.pi / 4096
    turn, follow = SPEED_M_S / RADIUS_M, SPEED_M_S / FOLLOWER_M
    return [
        Item(0, "u16", 1.0, lambda t_s: math.floor(t_s / 0.005 + 0.3)),
        Item(1, "u16", 1.0, still(107)),
        Item(2, "i32", 0.001, ripple(tension_N, 1.5), order),
        Item(4, "u16", 0.01, still(tension_N)),
        Item(5, "i16", 0.001, ripple(SPEED_M_S, 0.002, 2.1)),
        Item(6, "u16", 0.00002, still(RADIUS_M)),
        Item(7, "i16", 0.001, ripple(SPEED_M_S, 0.003, 1.3)),
        Item(8, "u16", 1.0, still(1)),
        Item(9, "i32", 0.001, ripple(95.0, 0.8, 1.05), order),
        Item(11, "i32", angle, turning(turn), order),
        Item(13, "i32", angle, turning(follow, 3.0), order),
        Item(15, "u16", 1.0, still(0)),
        Item(16, "i16", 1e-5, still(0)),
        Item(17, "i16", 1e-5, still(0)),
    ]
