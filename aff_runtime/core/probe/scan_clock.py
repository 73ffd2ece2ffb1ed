"""When the PLC took what a sample shows, told by its heartbeat.

Cycle and scan run on two clocks. Where a read falls on the edge of a scan it shows the one before
or the one behind as it happens, and what was read is half a scan early or late, at random: a roll
at 1 m/s is then some 2 mm off, more than a probe moves it. The heartbeat counts scans, so it says
which one was read. Whether it counts time at all is seen by the rolls: they turn steadily on the
better clock.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

FEWEST_COUNTS = 256
"""A heartbeat of any wire starts over after this many, or a multiple of it."""
WITHIN_SHARE = 0.99
"""Of the samples must lie within a cycle or a scan of the steady clock, or it is none: a scan that
takes as long as its work (free-running) counts work, not time. Of more, the rolls decide."""
STEADY_SAMPLES = 64
"""In which a roll turns at one speed: 0.3 s at 5 ms."""
STEADIER = 0.5
"""Jitter of the rolls on the PLC's clock over that on the cycle's, below which it is taken."""


def scan_time_s(time_s: Floats, heartbeat: Floats, counted_rad: Sequence[Floats] = ()) -> Floats:
    """Return when each sample was taken, on the PLC's clock; ``time_s`` where that is none.

    The PLC's clock is its count of scans, at the steady rate and from the origin that fit
    ``time_s`` best: on average no sample is moved, so no phase is.

    Parameters
    ----------
    time_s : (samples,) of the control cycle, rising, in s.
    heartbeat : (samples,) the PLC's heartbeat that each of them came with.
    counted_rad : (samples,) of each roll with an encoder, its angle.
    """
    elapsed_s = np.diff(time_s)
    counted = np.diff(heartbeat)
    forward = counted > 0.0
    if not np.isfinite(counted).all() or not forward.any():
        return time_s
    usual = float(np.median(counted[forward] / elapsed_s[forward])) * elapsed_s
    starts = np.rint((usual - counted) / FEWEST_COUNTS)
    counted += FEWEST_COUNTS * starts
    # a count that started over after anything else is off from there on, by any number
    off = np.abs(counted - usual)[starts != 0.0]
    if bool((off > 1.0 + max(1.0, float(np.median(usual)))).any()):
        return time_s
    count = np.concatenate([[0.0], np.cumsum(counted)])
    per_s, first = np.polyfit(time_s, count, 1)
    if not per_s > 0.0:
        return time_s
    taken_s = (count - first) / per_s
    within_s = max(1.0 / per_s, float(np.median(elapsed_s)))
    if float(np.mean(np.abs(taken_s - time_s) <= within_s)) >= WITHIN_SHARE:
        return np.asarray(taken_s)
    on_scans = sum(_jitter_s2(taken_s, angle) for angle in counted_rad)
    on_cycles = sum(_jitter_s2(time_s, angle) for angle in counted_rad)
    return np.asarray(taken_s) if on_scans < STEADIER**2 * on_cycles else time_s


def _jitter_s2(clock_s: Floats, angle_rad: Floats) -> float:
    """Return the mean square by which an angle is early or late on a clock, s^2.

    Against the straight line through ``STEADY_SAMPLES`` at a time; 0 for a roll that stands.
    """
    size = angle_rad.size // STEADY_SAMPLES * STEADY_SAMPLES
    folded = np.stack([clock_s[:size], angle_rad[:size]]).reshape(2, -1, STEADY_SAMPLES)
    clock, angle = folded - folded.mean(axis=2, keepdims=True)
    rate = (clock * angle).sum(1) / (clock**2).sum(1)
    turns = np.abs(rate) > 0.0
    late_s = (angle[turns] - rate[turns, None] * clock[turns]) / rate[turns, None]
    return float(np.mean(late_s**2)) if turns.any() else 0.0
