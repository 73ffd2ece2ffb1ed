"""A window over turns of a roll, and what repeats with them: amplitude per order."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

MOST_ORDERS = 12
PER_TURN = 64  # samples per turn, for orders up to MOST_ORDERS
LEAST_TURNS = 2
TURN_DEG = 360.0


def turns_of(angle_deg: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return turns since the first known angle, (n,); NaN where the angle is not known.

    Between two known angles a roll turns by less than half a turn, either way.
    """
    angle = np.asarray(angle_deg, dtype=np.float64) / TURN_DEG
    found = np.full(len(angle), np.nan)
    known = np.isfinite(angle)
    if known.any():
        whole = np.unwrap(angle[known], period=1.0)
        found[known] = np.abs(whole - whole[0])
    return found


def orders_of(
    turns: NDArray[np.float64], values: NDArray[np.floating]
) -> tuple[NDArray[np.float64], float]:
    """Return the amplitude of each order 1 ... ``MOST_ORDERS`` over whole turns, and the floor.

    The signal is taken at equal angles of whole turns; what does not repeat with the roll falls
    between its orders. The floor is the median amplitude of what lies between them.

    Returns
    -------
    orders : (MOST_ORDERS,), in the unit of the values; NaN while fewer than two turns are known.
    floor : of one such line; NaN likewise.
    """
    known = np.isfinite(turns) & np.isfinite(values)
    angle, signal = turns[known], np.asarray(values, dtype=np.float64)[known]
    nothing = np.full(MOST_ORDERS, np.nan)
    if len(angle) < 2:
        return nothing, math.nan
    angle = np.maximum.accumulate(angle)  # an encoder that stands trembles
    count = math.floor(angle[-1] - angle[0])
    if count < LEAST_TURNS or len(angle) < 2 * MOST_ORDERS * count:
        return nothing, math.nan
    at = angle[-1] - count + np.arange(count * PER_TURN) / PER_TURN
    even = np.interp(at, angle, signal)
    lines = 2.0 / len(even) * np.abs(np.fft.rfft(even - even.mean()))
    between = np.arange(1, MOST_ORDERS * count) % count != 0
    return lines[count : (MOST_ORDERS + 1) * count : count], float(
        np.median(lines[1 : MOST_ORDERS * count][between])
    )
