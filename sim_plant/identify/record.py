"""Recorded columns for an estimate, and what makes a column useless."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.identify.estimate import UndecidableError
from sim_plant.line.record_file import read_columns

_LONGEST_EQUAL_RUN = 12


def read_record(path: str | Path, needed: Sequence[str]) -> dict[str, Array]:
    """Return the needed columns of a record.

    Raises
    ------
    PlantError
        The file cannot be read, a needed column is missing, a number is not finite, or time
        does not increase; the message names file and column.
    """
    record = read_columns(Path(path), needed)
    if "time_s" in record and np.any(np.diff(record["time_s"]) <= 0.0):
        raise PlantError(f"{path}: time_s must increase from row to row")
    return record


def refuse_clipped(name: str, values: Array) -> None:
    """Raise when a moving signal rests on its own largest or smallest value.

    A converter at its end repeats one word; a noisy or moving signal does not. Runs of equal
    samples are allowed as long as they are everywhere in the record (a coarse resolution) and
    none fills a quarter of it (a dead channel).

    Raises
    ------
    UndecidableError
        The signal is clipped.
    """
    if values.size < 2:
        return
    edges = np.flatnonzero(np.diff(values) != 0.0)
    starts = np.concatenate(([0], edges + 1))
    lengths = np.diff(np.concatenate((starts, [values.size])))
    usual = float(np.median(lengths))
    for extreme, word in ((values.max(), "largest"), (values.min(), "smallest")):
        longest = int(np.max(lengths[values[starts] == extreme]))
        allowed = min(max(_LONGEST_EQUAL_RUN, 8.0 * usual), 0.25 * values.size)
        if longest > allowed and extreme != 0.0:
            raise UndecidableError(
                f"{name} is clipped: {longest} samples in a row stand at its {word} value "
                f"{extreme:g}. Record with a wider range."
            )
