"""When the PLC took what a sample shows, told by its heartbeat.

Cycle and scan run on two clocks. Where a read falls on the edge of a scan it shows the one before
or the one behind as it happens, and what was read is half a scan early or late, at random: a roll
at 1 m/s is then some 2 mm off, more than a probe moves it. The heartbeat counts scans, so it says
which one was read.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

FEWEST_COUNTS = 256
"""A heartbeat of any wire starts over after this many, or a multiple of it."""
WITHIN_SHARE = 0.99
"""Of the samples must lie within a cycle or a scan of the steady clock, or it is none: a scan that
takes as long as its work (free-running) counts work, not time."""


def scan_time_s(time_s: Floats, heartbeat: Floats) -> Floats:
    """Return when each sample was taken, on the PLC's clock; ``time_s`` where that is none.

    The PLC's clock is its count of scans, at the steady rate and from the origin that fit
    ``time_s`` best: on average no sample is moved, so no phase is.

    Parameters
    ----------
    time_s : (samples,) of the control cycle, rising, in s.
    heartbeat : (samples,) the PLC's heartbeat that each of them came with.
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
    if float(np.mean(np.abs(taken_s - time_s) <= within_s)) < WITHIN_SHARE:
        return time_s
    return np.asarray(taken_s)
