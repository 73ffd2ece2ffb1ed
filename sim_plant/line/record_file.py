"""Records as CSV, gzipped where named so: one header line of names with units, then samples."""

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
    opener = gzip.open if path.suffix == ".gz" else open
    try:
        with opener(path, "wt", encoding="ascii", newline="") as stream:
            stream.write(",".join(columns) + "\n")
            np.savetxt(stream, table, fmt="%.9g", delimiter=",")
    except OSError as error:
        raise PlantError(f"{path}: cannot be written ({error}). Name another --out.") from error


def read_columns(
    path: Path, names: Sequence[str] | None = None, *, finite: bool = True
) -> dict[str, Array]:
    """Return the named columns of a record, all of them for None, (samples,) each.

    ``finite`` False takes values that are none, such as readings a gateway did not get.

    Raises
    ------
    PlantError
        When the file is not such a record, a column is missing, or a value is not finite.
    """
    opener = gzip.open if path.suffix == ".gz" else open
    try:
        with opener(path, "rt", encoding="ascii") as stream:
            header = [name.strip() for name in next(csv.reader(stream), [])]
            names = header if names is None else names
            missing = [name for name in names if name not in header]
            if missing:
                raise PlantError(f"{path}:1: no column {missing[0]!r}; its header has {header}")
            table = np.loadtxt(stream, delimiter=",", ndmin=2)
    except (OSError, EOFError, ValueError, UnicodeDecodeError) as error:
        raise PlantError(f"{path}: not a record ({error}). Give a CSV or CSV.gz file.") from error
    if table.shape[0] == 0 or table.shape[1] != len(header):
        raise PlantError(f"{path}: {len(header)} names over {table.shape[1]} columns of samples")
    columns = {name: np.ascontiguousarray(table[:, header.index(name)]) for name in names}
    for name, values in columns.items():
        if finite and not np.isfinite(values).all():
            raise PlantError(f"{path}: column {name!r} holds a number that is not finite")
    return columns
