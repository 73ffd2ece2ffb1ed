"""Readings for the record alone: the service goes on without them, so a record may lack some."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.run_grid import LONGEST_HOLE_STEPS, Rows

RUN = CRITERIA.records.run


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Filled:
    """One channel in every scan.

    Attributes
    ----------
    values : (scans,); what is missing stands on a straight line between its neighbours.
    taken_s : when each scan was taken, s since the first. ``time_s`` : its time in the run.
    read : indices of the scans in which there was a reading.
    step_s : of the grid.
    """

    values: Array
    taken_s: Array
    time_s: Array
    read: Rows
    step_s: float

    def share_lacking(self, first: int, end: int) -> float:
        """Return the share of the scans from ``first`` to before ``end`` without a reading."""
        return 1.0 - float(np.sum((self.read >= first) & (self.read < end))) / (end - first)

    def holes_in(self, first: int, end: int) -> str:
        """Return what is missing for too long in the scans from ``first`` to before ``end``."""
        inside = self.read[(self.read >= first) & (self.read < end)]
        edges = np.concatenate(([first], inside, [end - 1]))
        intervals_s = np.diff(self.taken_s[edges])
        longest = int(np.argmax(intervals_s))
        if intervals_s[longest] <= LONGEST_HOLE_STEPS * self.step_s:
            return ""
        from_s, to_s = (self.time_s[edges[longest + k]] for k in (0, 1))
        return (
            f"it is for the record alone, and is missing from {from_s:.2f} s to {to_s:.2f} s of "
            "the run; give a window without that"
        )


def filled(values: Array, taken_s: Array, time_s: Array, step_s: float) -> Filled:
    """Return a channel without gaps, and where it had readings; (scans,) as given."""
    read = np.flatnonzero(np.abs(values) < RUN.largest_count)
    whole = np.interp(taken_s, taken_s[read], values[read]) if read.size else values
    return Filled(values=whole, taken_s=taken_s, time_s=time_s, read=read, step_s=step_s)
