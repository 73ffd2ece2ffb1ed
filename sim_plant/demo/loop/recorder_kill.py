"""The recorder ended by SIGKILL while it writes what the trace will read, and what that cost."""

from __future__ import annotations

import os
import re
import signal
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from aff_runtime.base.errors import PlantError
from aff_runtime.base.runs.table import RECORDER_DIED, RunTable, first_rows, read_table
from aff_runtime.base.runs.window import run_window

RECORDER = b"telemetry.recorder"
GOES_ON = "another one goes on"
HALF_A_DIGIT_S = 5e-5
"""Times of events have four decimals."""
_TORN = re.compile(r"signals-0*(\d+)\.csv\.gz: ends torn")


@dataclass(frozen=True, slots=True, kw_only=True)
class Loss:
    """What a run lacks of the time at which its recorder died; by its own rows.

    Attributes
    ----------
    at_s : of the last row that the one that died wrote, s of the run's ``time_s``.
    ticks, gone_s : that are in no row behind it, and from that row to the next, s.
    segment : file that it left; ``rows`` : whole ones read of it; ``torn`` : its end is missing.
    said : what the run says of itself.
    """

    at_s: float
    ticks: int
    gone_s: float
    segment: str
    rows: int
    torn: bool
    said: tuple[str, ...]

    def __str__(self) -> str:
        """Return it as one line."""
        lost = f"{self.ticks} ticks lost, {self.gone_s:.3f} s from row to row"
        end = "ends half-written" if self.torn else "ends whole"
        left = f"{self.segment} {end}, its {self.rows} whole rows are read"
        return f"recorder killed at {self.at_s:.1f} s of the run: {lost}; {left}"


def kill_recorder(service: int) -> int:
    """End the recorder of a service of ours by SIGKILL; return its process id.

    Raises
    ------
    PlantError
        The service has none.
    """
    children = Path(f"/proc/{service}/task/{service}/children").read_text(encoding="ascii")
    for pid in map(int, children.split()):
        if RECORDER in Path(f"/proc/{pid}/cmdline").read_bytes():
            os.kill(pid, signal.SIGKILL)
            return pid
    raise PlantError("the service has no recorder to kill; runtime.log says why")


def loss_of(run: str) -> Loss:
    """Return what the window of a run lacks since its recorder was killed.

    Raises
    ------
    PlantError
        No other recorder went on in it.
    """
    window = run_window(run)
    table = read_table(window, keep=lambda name: name == "tick")
    times = [row["time_s"] for row in table.events if row.get("name") == RECORDER_DIED]
    if not times:
        raise PlantError(
            f"{run}: no recorder went on behind the one that was killed; runtime.log says why"
        )
    return _loss(table, float(times[0]))


def _loss(table: RunTable, at_s: float) -> Loss:
    time_s, tick = table.columns["time_s"], table.columns["tick"]
    last = int(np.searchsorted(time_s, at_s + HALF_A_DIGIT_S, side="right")) - 1
    _, firsts = first_rows(table.window.folder)
    left = max((f for f in firsts if f.values["time_s"] <= time_s[last]), key=lambda f: f.number)
    ends = [t for t in table.lost if (found := _TORN.match(t)) and int(found[1]) == left.number]
    begun = max(left.values["time_s"], table.window.from_s)
    goes_on = last + 1 < time_s.size
    return Loss(
        at_s=at_s,
        ticks=round(float(tick[last + 1] - tick[last])) - 1 if goes_on else 0,
        gone_s=float(time_s[last + 1] - time_s[last]) if goes_on else 0.0,
        segment=f"signals-{left.number:04d}.csv.gz",
        rows=int(np.sum((time_s >= begun) & (time_s <= time_s[last]))),
        torn=bool(ends),
        said=(*ends, *(text for text in table.lost if GOES_ON in text)),
    )
