"""Recorded columns from CSV files, and what makes a column useless."""

from __future__ import annotations

import csv
import gzip
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.identify.estimate import UndecidableError

Record = Mapping[str, Array]
_LONGEST_EQUAL_RUN = 12


def read_record(path: str | Path, needed: Sequence[str]) -> dict[str, Array]:
    """Return the columns of a ``.csv`` or ``.csv.gz`` record with a header row.

    Raises
    ------
    PlantError
        The file cannot be read, a needed column is missing, a number is not finite, or time
        does not increase; the message names file and column.
    """
    try:
        opener = gzip.open if str(path).endswith(".gz") else open
        with opener(path, "rt", encoding="ascii") as stream:
            names = [name.strip() for name in next(csv.reader(stream), [])]
            table = np.loadtxt(stream, delimiter=",", ndmin=2)
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise PlantError(f"{path}: cannot be read as a CSV record ({error})") from error
    if table.shape[1] != len(names) or table.shape[0] < 2:
        raise PlantError(f"{path}: {len(names)} column names over {table.shape[1]} columns")
    record = {name: table[:, k] for k, name in enumerate(names)}
    for name in needed:
        if name not in record:
            raise PlantError(f"{path}: no column {name!r}; it has {', '.join(names)}")
        if not np.all(np.isfinite(record[name])):
            raise PlantError(f"{path}: column {name!r} holds a number that is not finite")
    if "time_s" in record and np.any(np.diff(record["time_s"]) <= 0.0):
        raise PlantError(f"{path}: time_s must increase from row to row")
    return record


def write_record(path: str | Path, record: Record) -> None:
    """Write columns of equal length as ``.csv`` or ``.csv.gz``."""
    table = np.column_stack(list(record.values()))
    np.savetxt(path, table, delimiter=",", header=",".join(record), comments="", fmt="%.9g")


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
