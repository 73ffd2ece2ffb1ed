"""Which correction acted on the line after each reading: what went out, wire and PLC included.

A correction computed in one tick is sent in the next, is taken by a scan of the PLC after that,
and acts until the following scan. A record's row is sampled before its correction acts.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.refine.records.run_grid import Rows

LEAST_COUNT = 1e-12
"""SI per count of the word; a smaller one is not worth rounding to."""
USUAL_CYCLES = 2
"""From a snapshot to the scan whose output has its correction: sent one tick later, and then the
scan after that takes it."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Delivered:
    """The correction of one actuator that acted from each good row's reading on.

    Attributes
    ----------
    values : (scans,), SI.
    how : a sentence: what this rests on.
    known : the PLC itself says it, or which command it took; False: a delay is assumed.
    """

    values: Array
    how: str
    known: bool


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
    sent = np.nan_to_num(columns[f"correction_{output}"])
    if count > LEAST_COUNT:
        sent = np.rint(sent / count) * count
    tick = columns["tick"]
    age = columns.get("echo_age", np.full(tick.shape, -1.0))[rows]
    if bool(np.all(age >= 0.0)):
        of_tick = tick[rows] - age - 1.0  # a tick sends what the one before it computed
        return Delivered(
            values=_at_tick(sent, tick, of_tick),
            how="as sent, with the command that the PLC's echo names",
            known=True,
        )
    # a declared delay includes the cycle in which the drive takes the correction
    cycles = USUAL_CYCLES if delay_s is None else max(0, round(delay_s / cycle_s) - 1)
    said = "the usual" if delay_s is None else "the site file's"
    return Delivered(
        values=_at_tick(sent, tick, tick[rows] - cycles),
        how=f"as sent, {cycles} cycles late ({said} delay)",
        known=False,
    )


def _at_tick(sent: Array, tick: Array, wanted: Array) -> Array:
    """Return what was decided in each wanted tick; of one that is missing, the last before it."""
    at = np.searchsorted(tick, wanted, side="right") - 1
    return np.where(at >= 0, sent[np.maximum(at, 0)], 0.0)
