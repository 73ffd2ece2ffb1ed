"""Read a record: CSV (also .gz), Parquet or MDF4; say what is odd, refuse the rest."""

from __future__ import annotations

import csv
import gzip
import hashlib
import zlib
from pathlib import Path

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.read_binary import Table, mdf_table, parquet_table
from sim_plant.refine.records.recording import Record
from sim_plant.refine.records.sanity import counted_on, even_grid, oddities, place_of
from sim_plant.refine.records.units import TO_SI, canonical, split_header

TIME_NAMES = ("time", "t", "timestamp")


def read_record(path: str | Path) -> Record:
    """Return the record in ``path``, SI, on an even grid.

    Raises
    ------
    PlantError
        When it cannot be read, a unit is unknown, a value is not a number, or stamps have gaps;
        the message names file, column and line.
    """
    path = Path(path)
    try:
        payload = path.read_bytes()
    except OSError as error:
        raise PlantError(f"{path}: cannot be read ({error})") from error
    raw, said = _table(path, payload)
    columns = {}
    for header, values in raw.items():
        name, factor = si_name(header, path)
        if name in columns:
            raise PlantError(f"{path}: column {name} appears twice, in two units")
        columns[name] = values * factor
    time_name = next((n for n in columns if n.lower().removesuffix("_s") in TIME_NAMES), None)
    if time_name is None:
        raise PlantError(f"{path}: no time column; name one time_s (found {sorted(columns)})")
    time_s = columns.pop(time_name)
    _finite(path, time_name, time_s)
    for name, values in columns.items():
        _finite(path, name, values)
    columns, counted = counted_on(columns)
    sample_time_s, columns, findings = even_grid(path, time_s, columns)
    return Record(
        path=path,
        sha256=hashlib.sha256(payload).hexdigest(),
        sample_time_s=sample_time_s,
        columns=columns,
        findings=(*said, *counted, *findings, *oddities(columns)),
    )


def si_name(header: str, path: Path) -> tuple[str, float]:
    """Return the channel name with its SI suffix, and the factor to SI.

    A unit in brackets is converted; a suffix alone must be one the program knows.
    """
    stem, unit = split_header(header)
    if not unit:
        return stem, 1.0
    unit = canonical(unit)
    if unit not in TO_SI:
        raise PlantError(
            f"{path}: column {header!r}: unit {unit!r} is unknown; use one of {sorted(TO_SI)}"
        )
    suffix, factor = TO_SI[unit]
    return f"{stem}_{suffix}", factor


def _finite(path: Path, name: str, values: Array) -> None:
    bad = np.flatnonzero(~(np.abs(values) < CRITERIA.records.largest_reading))
    if bad.size:
        finite = bool(np.isfinite(values[bad]).all())
        said = "are too large for a reading" if finite else "are missing or not numbers"
        raise PlantError(
            f"{path}: column {name}: {bad.size} values {said}, the first in "
            f"{place_of(path, int(bad[0]))}; cut the record there or record it again"
        )


def _table(path: Path, payload: bytes) -> Table:
    name = path.name.lower()
    if name.endswith((".csv", ".csv.gz", ".txt", ".txt.gz")):
        try:
            plain = gzip.decompress(payload) if name.endswith(".gz") else payload
            return _csv(path, plain.decode("utf-8-sig")), []
        except (OSError, EOFError, zlib.error, UnicodeDecodeError, csv.Error) as error:
            raise PlantError(f"{path}: not a readable CSV file ({error})") from error
    if name.endswith(".parquet"):
        return parquet_table(path, payload)
    if name.endswith((".mf4", ".mdf")):
        return mdf_table(path, payload)
    raise PlantError(f"{path}: unknown kind of file; give .csv, .csv.gz, .parquet or .mf4")


def _csv(path: Path, text: str) -> dict[str, Array]:
    lines = text.splitlines()
    if len(lines) < 3:
        raise PlantError(f"{path}: holds no rows")
    separator = max(",;\t", key=lines[0].count)
    header = [h.strip() for h in next(csv.reader([lines[0]], delimiter=separator))]
    if len(set(header)) < len(header):
        raise PlantError(f"{path}: line 1: a column name appears twice")
    rows = np.full((len(lines) - 1, len(header)), np.nan)
    for number, cells in enumerate(csv.reader(lines[1:], delimiter=separator), start=2):
        if len(cells) != len(header):
            raise PlantError(
                f"{path}: line {number}: {len(cells)} values under {len(header)} columns"
            )
        for k, cell in enumerate(cells):
            try:
                rows[number - 2, k] = float(cell) if cell.strip() else np.nan
            except ValueError as error:
                raise PlantError(
                    f"{path}: line {number}: column {header[k]}: read {cell!r}; expected a number"
                ) from error
    return {h: np.ascontiguousarray(rows[:, k]) for k, h in enumerate(header)}
