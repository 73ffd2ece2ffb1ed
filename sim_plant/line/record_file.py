"""Records as gzipped CSV: one header line of names with units, one row per sample."""

from __future__ import annotations

import csv
import gzip
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array


def write_columns(path: Path, columns: Mapping[str, Array]) -> None:
    """Write columns of equal length, nine significant digits.

    Raises
    ------
    PlantError
        When the file cannot be written.
    """
    table = np.column_stack(list(columns.values()))
    try:
        with gzip.open(path, "wt", encoding="ascii", newline="") as stream:
            stream.write(",".join(columns) + "\n")
            np.savetxt(stream, table, fmt="%.9g", delimiter=",")
    except OSError as error:
        raise PlantError(f"{path}: cannot be written ({error}). Name another --out.") from error


def read_columns(path: Path, names: Sequence[str]) -> dict[str, Array]:
    """Return the named columns of a record, (samples,) each.

    Raises
    ------
    PlantError
        When the file is not such a record, a column is missing, or a value is not finite.
    """
    try:
        opened = gzip.open if path.suffix == ".gz" else open
        with opened(path, "rt", encoding="ascii") as stream:
            header = next(csv.reader(stream), [])
            missing = [name for name in names if name not in header]
            if missing:
                raise PlantError(f"{path}:1: no column {missing[0]}; its header has {header}")
            use = [header.index(name) for name in names]
            table = np.loadtxt(stream, delimiter=",", usecols=use, ndmin=2)
    except (OSError, ValueError, UnicodeDecodeError) as error:
        raise PlantError(f"{path}: not a record ({error}). Give a CSV or CSV.gz file.") from error
    if table.shape[0] == 0 or not np.isfinite(table).all():
        raise PlantError(f"{path}: empty, or a value of {list(names)} is not a finite number")
    return {name: np.ascontiguousarray(table[:, k]) for k, name in enumerate(names)}
