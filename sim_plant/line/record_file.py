"""Records as CSV, gzipped where named so: one header line of names with units, then samples."""

from __future__ import annotations

import csv
import gzip
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TextIO

import numpy as np

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from sim_plant.base.arrays import Array
from sim_plant.base.plain_file import read_plain, text_stream

LONGEST_BYTES = 256 << 20
"""The file, and what it is unpacked: 1 GB of doubles at the most."""
LONGEST_LINE = 1 << 20


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
    payload, shown = read_plain(path, LONGEST_BYTES), printable(str(path))
    try:
        with text_stream(path, payload, LONGEST_BYTES) as stream:
            header = [name.strip() for name in next(csv.reader([stream.readline(LONGEST_LINE)]))]
            names = header if names is None else names
            missing = [name for name in names if name not in header]
            if missing:
                found = printable(str(header), 500)
                raise PlantError(f"{shown}:1: no column {missing[0]!r}; its header has {found}")
            table = np.loadtxt(_lines(shown, stream), delimiter=",", ndmin=2)
    except (OSError, EOFError, ValueError, csv.Error, zlib.error) as error:
        said = printable(str(error), 200)
        raise PlantError(f"{shown}: not a record ({said}). Give a CSV or CSV.gz file.") from error
    if table.shape[0] == 0 or table.shape[1] != len(header):
        raise PlantError(f"{shown}: {len(header)} names over {table.shape[1]} columns of samples")
    columns = {name: np.ascontiguousarray(table[:, header.index(name)]) for name in names}
    for name, values in columns.items():
        if finite and not np.isfinite(values).all():
            raise PlantError(f"{shown}: column {name!r} holds a number that is not finite")
    return columns


def _lines(shown: str, stream: TextIO) -> Iterator[str]:
    """Yield the lines below the header; numpy takes some 20 bytes for every character of one."""
    number = 1
    while line := stream.readline(LONGEST_LINE + 1):
        number += 1
        if len(line) > LONGEST_LINE:
            raise PlantError(f"{shown}: line {number} is longer than {LONGEST_LINE} characters")
        yield line
