"""Read a record: CSV (also .gz), Parquet, MDF or a run; say what is odd, refuse the rest."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from aff_runtime.base.counted_noun import counted
from aff_runtime.base.errors import PlantError
from aff_runtime.base.files import CLOSED_TEXT, is_closed
from aff_runtime.base.printable import printable
from aff_runtime.base.runs.segment import segments_of
from aff_runtime.base.runs.table import no_run_text
from aff_runtime.base.runs.window import names_a_run
from sim_plant.base.arrays import Array
from sim_plant.base.plain_file import read_plain
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.in_child import table_from_child
from sim_plant.refine.records.limits import FILE_BYTES, check_name, path_text
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.records.run_record import read_run_record
from sim_plant.refine.records.sanity import even_grid, oddities, row_words, unwrapped
from sim_plant.refine.records.text_table import text_table
from sim_plant.refine.records.units import TO_SI, canonical, split_header

TIME_NAMES = ("time", "t", "timestamp")
KINDS = {  # a record's reader by the endings of its name
    (".csv", ".csv.gz", ".txt", ".txt.gz"): "text",
    (".parquet",): "parquet",
    (".mf4", ".mdf"): "mdf",
}


def read_record(path: str | Path) -> Recording:
    """Return the record in ``path``, SI, on an even grid.

    Parquet and MDF go through large libraries, one of which evaluates text: a child of its own
    reads each such file, with limits on memory and time (`in_child`). It costs 0.2 s for
    Parquet and 0.8 s for MDF, nearly all of it imports that this process is spared. CSV is
    read here, by code of this package that holds 8 bytes for a number and nothing more: a child
    would cost 0.2 s a file and bound nothing that is not bounded already.

    Raises
    ------
    PlantError
        When it cannot be read, is too large, a unit is unknown, a value is not a number, or
        stamps have gaps; the message names file, column and line.
    """
    path = Path(path)
    if names_a_run(path):
        return read_run_record(path)
    if names_a_run(path.parent) and path in (segment for _, segment in segments_of(path.parent)):
        run = printable(str(path.parent))
        raise PlantError(
            f"{printable(str(path))}: is one segment of a run, whose rows are not on the PLC's "
            f"scans; give the run's folder, {run}, or a part of it, {run}@FROM..TO"
        )
    kind = kind_of(path)
    payload = read_plain(path, FILE_BYTES)
    said: list[str] = []
    if kind == "text":
        raw = text_table(path, payload)
    else:
        raw, said = table_from_child(path, kind, payload)
    columns = _si_columns(path, raw)
    time_name = next((n for n in columns if n.lower().removesuffix("_s") in TIME_NAMES), None)
    if time_name is None:
        names = printable(str(sorted(columns)), 500)
        raise PlantError(f"{path_text(path)}: no time column; name one time_s (found {names})")
    time_s = columns.pop(time_name)
    if not columns:
        raise PlantError(f"{path_text(path)}: holds no channel beside {time_name}")
    for name, values in {time_name: time_s, **columns}.items():
        if values.shape != time_s.shape:
            raise PlantError(
                f"{path_text(path)}: column {name} holds {values.size} values where there are "
                f"{time_s.size} stamps; export the channel anew"
            )
        _refuse_non_numbers(path, name, values)
    columns, counted = unwrapped(columns)
    sample_time_s, columns, findings = even_grid(path, time_s, columns)
    zeros_rad = {n: float(v[0]) for n, v in columns.items() if n.endswith("_angle_rad")}
    columns = {**columns, **{name: columns[name] - zero for name, zero in zeros_rad.items()}}
    return Recording(
        path=path,
        sha256=hashlib.sha256(payload).hexdigest(),
        sample_time_s=sample_time_s,
        columns=columns,
        findings=(*said, *counted, *findings, *oddities(columns)),
        zeros_rad=zeros_rad,
    )


def kind_of(path: Path) -> str:
    """Return what a record's name says it is: text, parquet or mdf; PlantError for others."""
    for endings, kind in KINDS.items():
        if path.name.lower().endswith(endings):
            return kind
    folder, at, _ = str(path).rpartition("@")
    if os.path.isdir(path) or (at and os.path.isdir(folder)):
        raise PlantError(no_run_text(path))
    if is_closed(path) or (at and is_closed(Path(folder))):
        raise PlantError(f"{path_text(path)}: {CLOSED_TEXT}")
    what = "unknown kind of file" if os.path.exists(path) else "is not there"
    raise PlantError(
        f"{path_text(path)}: {what}; give .csv, .csv.gz, .parquet, .mf4 or "
        ".mdf, or the folder of a run (RUN_DIR or RUN_DIR@FROM..TO)"
    )


def si_name(header: str, path: Path) -> tuple[str, float]:
    """Return the channel name with its SI suffix, and the factor to SI.

    A unit in brackets is converted; a suffix alone must be one the program knows. What does not
    print comes out escaped, so no name acts on a terminal, in a log or in a page further on.
    """
    check_name(path, header)
    stem, unit = split_header(printable(" ".join(header.split())))
    if not unit:
        return stem, 1.0
    unit = canonical(unit)
    if unit not in TO_SI:
        raise PlantError(
            f"{path_text(path)}: column {printable(header)!r}: unit {unit!r} is unknown; "
            f"use one of {sorted(TO_SI)}"
        )
    suffix, factor = TO_SI[unit]
    return f"{stem}_{suffix}", factor


def _si_columns(path: Path, raw: Mapping[str, Array]) -> dict[str, Array]:
    """Return columns by channel name, SI."""
    columns: dict[str, Array] = {}
    for header, values in raw.items():
        name, factor = si_name(header, path)
        if name in columns:
            raise PlantError(f"{path_text(path)}: column {name} appears twice, in two units")
        with np.errstate(over="ignore"):  # what is too large is refused below, with its row
            columns[name] = values * factor
    return columns


def _refuse_non_numbers(path: Path, name: str, values: Array) -> None:
    """Refuse readings that are missing, no numbers, or too large."""
    bad = np.flatnonzero(~(np.abs(values) < CRITERIA.records.largest_reading))
    if bad.size:
        is_one = bad.size == 1
        if bool(np.isfinite(values[bad]).all()):
            what = "too large for a reading"
        else:
            what = "missing or not a number" if is_one else "missing or not numbers"
        said = f"{counted(bad.size, 'value')} {'is' if is_one else 'are'} {what}"
        where = "in" if is_one else "the first in"
        raise PlantError(
            f"{path_text(path)}: column {name}: {said}, {where} "
            f"{row_words(path, int(bad[0]))}; cut the record there or record it again"
        )
