"""Parquet and MDF4 records as columns with units in their headers."""

from __future__ import annotations

import importlib
import io
from pathlib import Path
from typing import Any

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import Array

Table = tuple[dict[str, Array], list[str]]
"""Columns by header, and what is to be said about them."""


def parquet_table(path: Path, payload: bytes) -> Table:
    """Return the columns of a Parquet file; a field's metadata ``unit`` counts as its header's.

    A column of time stamps becomes seconds since its first row. Missing values become NaN.

    Raises
    ------
    PlantError
        When it is not a Parquet file, or a column holds no numbers.
    """
    reader = _package(path, "pyarrow.parquet", "pyarrow")
    arrow = _package(path, "pyarrow", "pyarrow")
    try:
        table = reader.read_table(io.BytesIO(payload))
    except (arrow.ArrowException, OSError) as error:
        raise PlantError(f"{path}: not a readable Parquet file ({error})") from error
    found: dict[str, Array] = {}
    for field in table.schema:
        values = table[field.name].to_numpy()
        unit = (field.metadata or {}).get(b"unit", b"").decode("utf-8", "replace")
        if values.dtype.kind == "M":
            values, unit = (values - values[:1]) / np.timedelta64(1, "s"), "s"
        found[_header(path, found, field.name, unit)] = _numbers(path, field.name, values)
    return found, []


def mdf_table(path: Path, payload: bytes) -> Table:
    """Return the channels of an MDF file on the stamps of its fastest group, from 0 s on.

    Channels of slower groups are put between their neighbours in time, which is said.

    Raises
    ------
    PlantError
        When it is not an MDF file, holds no channel, a channel holds no numbers, or a slower
        group covers another stretch of time.
    """
    package = _package(path, "asammdf", "asammdf")
    try:
        with package.MDF(io.BytesIO(payload)) as mdf:
            signals = [s for s in mdf.iter_channels(skip_master=True) if s.timestamps.size]
    except Exception as error:  # its own and those of broken blocks: struct, zlib, index, value
        raise PlantError(f"{path}: not a readable MDF file ({error})") from error
    if not signals:
        raise PlantError(f"{path}: holds no channel with values")
    master = max((s.timestamps for s in signals), key=lambda stamps: stamps.size)
    time_s: Array = np.asarray(master - master[0], dtype=np.float64)
    found, said = {"time_s": time_s}, []
    for signal in signals:
        values = _numbers(path, signal.name, signal.samples)
        if signal.invalidation_bits is not None:
            values = np.where(np.asarray(signal.invalidation_bits, dtype=bool), np.nan, values)
        if not np.array_equal(signal.timestamps, master):
            values = _on_stamps(path, signal, values, master)
            said.append(f"{signal.name} has stamps of its own: put on those of the fastest group")
        found[_header(path, found, signal.name, signal.unit)] = values
    return found, said


def _on_stamps(path: Path, signal: Any, values: Array, master: Array) -> Array:
    stamps = signal.timestamps
    longest = float(np.max(np.diff(stamps), initial=0.0))
    if stamps[0] - master[0] > longest or master[-1] - stamps[-1] > longest:
        raise PlantError(
            f"{path}: channel {signal.name} runs from {stamps[0]:.6g} s to {stamps[-1]:.6g} s, "
            f"others from {master[0]:.6g} s to {master[-1]:.6g} s; cut the record to what all have"
        )
    found: Array = np.interp(master, stamps, values)
    return found


def _header(path: Path, taken: dict[str, Array], name: str, unit: str) -> str:
    header = f"{name} [{unit}]" if unit else name  # a unit that is given beats the name
    if header in taken:
        raise PlantError(f"{path}: a column name appears twice: {header}")
    return header


def _numbers(path: Path, name: str, values: Any) -> Array:
    kind = np.asarray(values).dtype
    if kind.kind not in "fiub":
        raise PlantError(f"{path}: column {name} holds {kind}; expected numbers")
    return np.asarray(values, dtype=np.float64)


def _package(path: Path, module: str, package: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise PlantError(f"{path}: needs the package {package}: pip install {package}") from error
