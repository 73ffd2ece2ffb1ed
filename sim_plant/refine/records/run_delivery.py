"""Which correction acted on the line after each reading: what went out, wire and PLC included.

A correction computed in one tick is sent in the next, is taken by a scan of the PLC after that,
and acts until the following scan. A record's row is sampled before its correction acts.

A scan that no row shows takes the command that was sent last, as every scan does. In a tick that
was missed nothing was sent: the first scan after a row takes what that row's own exchange left
with the PLC, and all take it until the next exchange, whose row shows it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from aff_runtime.base.signals import Outcome
from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.run_grid import Flags, Rows

RUN = CRITERIA.records.run
LEAST_COUNT = 1e-12
"""SI per count of the word; a smaller one is not worth rounding to."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Delivered:
    """The correction of one actuator that acted from each scan's reading on.

    Attributes
    ----------
    values : (scans,), SI.
    how : a sentence: what this rests on.
    known : the PLC itself says what it applied, or which command it took; False: a delay is
        assumed.
    unknown_first : so many of the first scans carry what was decided before the record, or before
        a hole in it, while AFF corrected: no one knows what.
    """

    values: Array
    how: str
    known: bool
    unknown_first: int = 0


def delivered(
    columns: Mapping[str, Array],
    output: str,
    rows: Rows,
    *,
    count: float,
    delay_s: float | None,
    cycle_s: float,
) -> Delivered:
    """Return what acted of the output ``output`` (name with unit) after the readings in ``rows``.

    Parameters
    ----------
    columns : whole table, all rows.
    count : correction in one count of the word; 0: not known.
    delay_s : declared time from a snapshot to its correction at the drive, or None.
    cycle_s : period of the ticks.
    """
    shown = columns.get(f"plc_applied_{output}")
    if shown is not None and bool(np.isfinite(shown[rows]).all()):
        return Delivered(values=shown[rows], how="as the PLC reports it applied", known=True)
    sent, tick = columns[f"correction_{output}"], columns["tick"]
    if count > LEAST_COUNT:
        sent = np.rint(sent / count) * count
    age = columns.get("echo_age", np.full(tick.shape, -1.0))[rows]
    if known := bool(np.all(age >= 0.0)):
        of_tick = tick[rows] - age - 1.0  # a tick sends what the one before it computed
        how = "as sent, with the command that the PLC's echo names"
    else:
        # a declared delay includes the cycle in which the drive takes the correction
        cycles = RUN.usual_cycles if delay_s is None else max(0, round(delay_s / cycle_s) - 1)
        said = "the usual" if delay_s is None else "the site file's"
        of_tick = tick[rows] - cycles
        how = f"as sent, {cycles} cycles late ({said} delay)"
    is_number = np.isfinite(sent)
    if not is_number.all():
        how += f"; in {np.sum(~is_number)} rows it is no number: the one before stands in"
        # a tick without one is as one that is missing
        sent, tick = sent[is_number], tick[is_number]
    return Delivered(
        values=_at_tick(sent, tick, of_tick),
        how=how,
        known=known,
        unknown_first=_unknown_first(sent, tick, of_tick, columns["tick"][rows[0]]),
    )


def _unknown_first(sent: Array, tick: Array, wanted: Array, first_tick: float) -> int:
    """Return of how many of the first scans the wanted ticks are none of those that are there.

    0 where nothing was sent in as many ticks from the first row on: nothing was before either.
    """
    if not tick.size:
        return 0
    at = np.searchsorted(tick, wanted, side="right") - 1
    absent = (at < 0) | (wanted - tick[np.maximum(at, 0)] > RUN.filled_samples)
    count = int(np.argmin(absent)) if not absent.all() else absent.size
    begins = int(np.searchsorted(tick, first_tick))
    return count if np.any(sent[begins : begins + max(count, 1)]) else 0


def _at_tick(sent: Array, tick: Array, wanted: Array) -> Array:
    """Return what was decided in each wanted tick; of one that is missing, the last before it."""
    if not tick.size:
        return np.zeros(wanted.shape)
    at = np.searchsorted(tick, wanted, side="right") - 1
    return np.where(at >= 0, sent[np.maximum(at, 0)], 0.0)


def sent_unseen(columns: Mapping[str, Array], rows: Rows) -> Flags:
    """Return per row (scans,) whether a scan before it may have taken a command that none shows.

    That is where an exchange between it and the row before failed, showed a scan that is left out,
    or is of a row that is lost. An exchange that showed no new scan came before those missing.
    """
    waited = (columns["outcome"] == Outcome.OK) & ~(columns["fresh"] > 0)
    other = np.concatenate(([0], np.cumsum(~waited)))
    unseen = np.zeros(rows.shape, dtype=np.bool_)
    between = other[rows[1:]] - other[rows[:-1] + 1]
    lost = np.diff(columns["tick"][rows]) > np.diff(rows)
    unseen[1:] = (between > 0) | lost
    return unseen


def on_grid(values: Array, taken_s: Array, grid: Array, *, scan_s: float, unseen: Flags) -> Array:
    """Return what acted from every sample of a grid (samples,) on, s as ``taken_s``.

    ``values``, ``taken_s`` : what acted from each scan with a row on, and when that was (scans,).
    Where a scan that no row shows may have taken an ``unseen`` command, what lies on a straight
    line between its neighbours stands in.
    """
    newest = np.searchsorted(taken_s, grid + 1e-9, side="right") - 1
    following = np.minimum(newest + 1, values.size - 1)
    shown = grid - taken_s[newest] < (1.0 - RUN.same_scan_share) * scan_s
    between = np.interp(grid, taken_s, values)
    held = np.where(unseen[following], between, values[following])
    return np.where(shown, values[newest], held)
