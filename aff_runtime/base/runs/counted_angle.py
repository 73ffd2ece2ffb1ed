"""A counted angle that goes on where its register starts over, and over what lacks of a record.

Between two readings the roll turned about as fast as around them: that says how often the count
started over. All else is the count itself, so that the phase stays that of the roll. Where the
motion over a hole is known too badly for that, and the count does not start over after whole
turns, or where the count was set anew, the phase is lost, and another part begins.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from aff_runtime.base.early_wrap import ALIKE_SHARE, FEWEST_WRAPS, EarlyWrap
from aff_runtime.base.runs.holes import cycle_s_of, holes_between
from aff_runtime.base.units import UnitError, read_scale
from aff_runtime.base.yaml_section import Section

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Numbers = NDArray[np.int64]

WORD_COUNTS: Mapping[str, int] = {"u16": 2**16, "i16": 2**16, "u32": 2**32, "i32": 2**32}
"""Counts of a register by the type of its word."""
LEAST_COUNTS = 8
"""After which a count may start over, as the site file lets it."""
ORIGIN_SLACK_RAD = 1e-3
"""A range this close to whole turns is whole turns."""
LARGEST_MISS_RAD = math.pi
"""A reading that is further from where its roll should be is no reading of the same count."""
RATE_READINGS = 200
"""Over so many the speed is a mean: one count is then a small share of the motion."""
UNSEEN_SHARE = 0.02
"""Of the motion over a hole by the speeds around it: a line at one speed keeps within that."""
JUMP_STEPS, JUMP_SPREADS = 2.5, 12.0
"""A step jumps that is off by more than so many steps, a late reading and the one after it, and
so many medians of what steps are off by."""
LATE_CYCLES = 2.0
"""By so much a reading may be older than its row: a scan of the PLC at either end of a step."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CountedAngle:
    """The angle of a roll by its counter, a number per row.

    Attributes
    ----------
    angle_rad : rising, whichever way it counts, at standstill too.
    good : the row goes on from the one before without a hole or a jump.
    part : rows of one number hang together in phase.
    """

    angle_rad: Array
    good: Flags
    part: Numbers


def range_counts(channel: Section) -> int:
    """Return the counts after which a site file says that a channel starts over; 0 where none."""
    counts = WORD_COUNTS.get(str(channel.get("type")), 0)
    after = channel.get("wraps_after")
    if isinstance(after, int) and not isinstance(after, bool):
        return after if LEAST_COUNTS <= after <= counts else counts
    return counts


def modulus_rad(channel: Section) -> float:
    """Return the range after which the counter of a site file's channel starts over, rad.

    Infinite where it does not, and on CAN, where the reader unfolds the count before it is
    recorded. What no site file may have as ``wraps_after`` is left out: its word says the range.
    """
    counts = range_counts(channel)
    if not counts or channel.get("wraps") is not True:
        return math.inf
    try:
        return counts * abs(read_scale(channel.get("scale"), "rad")) or math.inf
    except UnitError:
        return math.inf


def early_wrap(time_s: Array, count_rad: Array, modulus_rad: float) -> EarlyWrap | None:
    """Return after what a count (rows,) starts over early, None where it does not, or who knows.

    Each time it does, its step is off by the same, and from one to the next it counted that far.
    """
    known = np.flatnonzero(np.isfinite(count_rad))
    if known.size <= FEWEST_WRAPS or not math.isfinite(modulus_rad):
        return None
    steps = _steps(time_s[known], count_rad[known], modulus_rad, cycle_s_of(time_s))
    followed = ~steps.is_hole
    way = 1.0 if np.sum(steps.expected_rad) >= 0.0 else -1.0
    off = way * (steps.moved_rad - steps.expected_rad)
    usual = JUMP_STEPS * np.abs(steps.expected_rad)
    usual += JUMP_SPREADS * float(np.median(np.abs(off[followed]))) if followed.any() else 0.0
    jumps = np.flatnonzero(followed & (np.abs(off) > usual))
    if jumps.size < FEWEST_WRAPS:
        return None
    back = np.mod(-off[jumps], modulus_rad)
    range_rad, off_rad = float(np.median(back)), float(np.median(usual[jumps]))
    alike = np.abs(back - range_rad) <= off_rad
    jumps, back = jumps[alike], back[alike]
    true = way * np.where(np.abs(off) > usual, steps.expected_rad, steps.moved_rad)
    apart = np.diff(np.cumsum(true)[jumps])
    is_due = np.abs(apart - range_rad * np.round(apart / range_rad)) <= 2.0 * off_rad
    enough = np.mean(alike) >= ALIKE_SHARE and 1 + np.sum(is_due) >= FEWEST_WRAPS
    if not enough or np.mean(is_due) < ALIKE_SHARE or range_rad < 4.0 * off_rad:
        return None
    return EarlyWrap(range_rad=range_rad, off_rad=off_rad, seen=int(jumps.size))


def is_whole_turns(modulus_rad: float) -> bool:
    """Return whether a range is whole turns: the count then has one zero of the roll."""
    turns = modulus_rad / math.tau
    if not math.isfinite(turns) or round(turns) < 1:
        return False
    return abs(turns - round(turns)) * math.tau < ORIGIN_SLACK_RAD


def counted_angle(time_s: Array, count_rad: Array, modulus_rad: float) -> CountedAngle:
    """Return the angle by a counter (rows,) that starts over after ``modulus_rad``.

    The service records it unfolded, others as it was read. A count that is no number is bridged
    like a missed tick; a single one that fits neither the one before nor the one after is left
    out. The roll must turn by less than half the range, and by less than half a turn, from one
    cycle to the next.
    """
    known = np.flatnonzero(np.isfinite(count_rad))
    if known.size < 2:
        nothing = np.zeros(time_s.shape)
        return CountedAngle(
            angle_rad=nothing, good=nothing > 0.0, part=np.zeros(time_s.shape, dtype=np.int64)
        )
    cycle_s = cycle_s_of(time_s)
    steps = _steps(time_s[known], count_rad[known], modulus_rad, cycle_s)
    wrong = _wrong(steps, count_rad[known], modulus_rad)
    if wrong.any():
        known = known[~wrong]
        steps = _steps(time_s[known], count_rad[known], modulus_rad, cycle_s)
    broken = steps.is_jump | _is_lost(steps, modulus_rad)
    angle = np.append(0.0, np.cumsum(np.where(broken, steps.expected_rad, steps.moved_rad)))
    angle *= 1.0 if angle[-1] >= 0.0 else -1.0
    angle = np.maximum.accumulate(angle)  # no creep where the count trembles at standstill
    good = np.append(True, ~(steps.is_hole | broken))
    good[:-1] &= ~broken
    rows = np.arange(time_s.size)
    after = np.minimum(np.searchsorted(known, rows), known.size - 1)
    return CountedAngle(
        angle_rad=np.interp(rows, known, angle) + 1e-12 * rows,
        good=good[after] & (rows >= known[0]) & (rows <= known[-1]),
        part=np.append(0, np.cumsum(broken))[after],
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Steps:
    """From each reading to the next; ``expected_rad`` may be off by ``tolerance_rad``."""

    moved_rad: Array
    expected_rad: Array
    tolerance_rad: Array
    is_hole: Flags
    is_jump: Flags


def _steps(time_s: Array, count_rad: Array, modulus_rad: float, cycle_s: float) -> _Steps:
    gaps_s = np.diff(time_s)
    is_hole = holes_between(time_s, cycle_s)
    turned = np.diff(count_rad)
    rate = _rates(gaps_s, _unfolded(turned, np.zeros_like(turned), modulus_rad), is_hole)
    gaps_s = np.maximum(gaps_s, 0.0)
    at = np.arange(turned.size) + 0.5
    before, after = (
        np.interp(at + away, *rate) for away in (-0.5 * RATE_READINGS, 0.5 * RATE_READINGS)
    )
    mean = np.interp(at, *rate)
    expected = mean * gaps_s
    moved = _unfolded(turned, expected, modulus_rad)
    tolerance = UNSEEN_SHARE * np.abs(expected) + 0.5 * np.abs(after - before) * gaps_s
    return _Steps(
        moved_rad=moved,
        expected_rad=expected,
        tolerance_rad=tolerance + LATE_CYCLES * cycle_s * np.abs(mean),
        is_hole=is_hole,
        is_jump=~is_hole & (np.abs(moved - expected) > LARGEST_MISS_RAD),
    )


def _unfolded(turned: Array, expected: Array, modulus_rad: float) -> Array:
    """Return the motion nearest to the expected one, of all that the count may stand for."""
    if not math.isfinite(modulus_rad):
        return turned
    unfolded: Array = turned + modulus_rad * np.round((expected - turned) / modulus_rad)
    return unfolded


def _rates(gaps_s: Array, steps: Array, is_hole: Flags) -> tuple[Array, Array]:
    """Return middles (in steps) of groups of ``RATE_READINGS``, and the mean speed of each, rad/s.

    Steps far from the median of their group are left out: jumps, wraps that were folded wrongly.
    """
    usable = ~is_hole
    if not usable.any():
        return np.zeros(1), np.zeros(1)
    speeds = np.divide(steps, gaps_s, out=np.zeros_like(steps), where=usable)
    speeds[is_hole] = np.median(speeds[usable])
    starts = np.arange(0, steps.size, RATE_READINGS)
    rest = np.full(starts.size * RATE_READINGS - steps.size, speeds[-1])
    medians = np.median(np.append(speeds, rest).reshape(starts.size, -1), axis=1)
    usual = np.repeat(medians, RATE_READINGS)[: steps.size]
    near = usable & (np.abs(steps - usual * gaps_s) < LARGEST_MISS_RAD)
    moved = np.add.reduceat(np.where(near, steps, 0.0), starts)
    took_s = np.add.reduceat(np.where(near, gaps_s, 0.0), starts)
    found = took_s > 0.0
    if not found.any():
        return np.zeros(1), np.zeros(1)
    middles = starts.astype(np.float64) + 0.5 * RATE_READINGS
    return middles[found], moved[found] / took_s[found]


def _wrong(steps: _Steps, count_rad: Array, modulus_rad: float) -> Flags:
    """Return per reading whether it alone is wrong: the next one goes on from the one before."""
    wrong = np.zeros(count_rad.shape, dtype=np.bool_)
    expected = steps.expected_rad[:-1] + steps.expected_rad[1:]
    over = _unfolded(count_rad[2:] - count_rad[:-2], expected, modulus_rad)
    goes_on = np.abs(over - expected) <= LARGEST_MISS_RAD
    wrong[1:-1] = steps.is_jump[:-1] & steps.is_jump[1:] & goes_on
    return wrong


def _is_lost(steps: _Steps, modulus_rad: float) -> Flags:
    """Return over which holes the phase is lost: the count may stand for more than one motion."""
    if is_whole_turns(modulus_rad) or not math.isfinite(modulus_rad):
        return np.zeros(steps.is_hole.shape, dtype=np.bool_)
    is_near = np.abs(steps.moved_rad - steps.expected_rad) <= steps.tolerance_rad
    is_one = is_near & (2.0 * steps.tolerance_rad < modulus_rad)
    return steps.is_hole & ~is_one & (4.0 * np.abs(steps.expected_rad) > modulus_rad)
