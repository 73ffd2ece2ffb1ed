"""Parquet records as columns with units in their headers."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from sim_plant.base.arrays import Array
from sim_plant.base.plain_file import megabytes
from sim_plant.refine.records.columns import Table, header_of, module_of_extra, numbers
from sim_plant.refine.records.limits import UNPACKED_BYTES, check_size, path_text


def parquet_table(path: Path, payload: bytes) -> Table:
    """Return the columns of a Parquet file; a field's metadata ``unit`` counts as its header's.

    Rows, columns, kinds and unpacked sizes are judged by the footer before a value is read. A
    column of time stamps becomes seconds since its first one. Missing values become NaN.

    Raises
    ------
    PlantError
        When it is not a Parquet file, is too large, or a column holds no numbers.
    """
    reader = module_of_extra(path, "pyarrow.parquet", "pyarrow")
    arrow = module_of_extra(path, "pyarrow", "pyarrow")
    try:
        file = reader.ParquetFile(io.BytesIO(payload), pre_buffer=False)
        _check_footer(path, file, file.schema_arrow, arrow.types)
        return _columns(path, file), []
    except MemoryError:  # one of Arrow's own is also this
        raise
    except (arrow.ArrowException, OSError, ValueError) as error:
        said = printable(str(error), 200)
        raise PlantError(f"{path_text(path)}: not a readable Parquet file ({said})") from error


def _columns(path: Path, file: Any) -> dict[str, Array]:
    """Return the columns, each read and turned into doubles before the next.

    That takes half the memory of reading the whole file first.
    """
    arrow = module_of_extra(path, "pyarrow", "pyarrow")
    columns: dict[str, Array] = {}
    for field in file.schema_arrow:
        part = file.read(columns=[field.name], use_threads=False)
        column = part.column(part.schema.get_field_index(field.name))
        if arrow.types.is_null(field.type) or arrow.types.is_boolean(field.type):
            column = column.cast(arrow.float64())  # numpy has no missing value of these kinds
        values = column.to_numpy()
        unit = (field.metadata or {}).get(b"unit", b"").decode("utf-8", "replace")
        if values.dtype.kind == "M":
            first = next(iter(values[~np.isnat(values)][:1]), np.datetime64("NaT"))
            values, unit = (values - first) / np.timedelta64(1, "s"), "s"
        columns[header_of(path, columns, field.name, unit)] = numbers(path, field.name, values)
    return columns


def _check_footer(path: Path, file: Any, schema: Any, types: Any) -> None:
    """Refuse by the footer what is too large, or holds other things than numbers and stamps."""
    footer = file.metadata
    columns = max(footer.num_columns, len(schema))
    check_size(path, columns, footer.num_rows * columns)
    groups = [footer.row_group(k) for k in range(footer.num_row_groups)]
    if any(g.num_rows < 0 or g.total_byte_size < 0 for g in groups):
        raise PlantError(f"{path_text(path)}: not a readable Parquet file (a size below 0)")
    unpacked_bytes = sum(g.total_byte_size for g in groups)
    if unpacked_bytes > UNPACKED_BYTES:
        raise PlantError(
            f"{path_text(path)}: has {megabytes(unpacked_bytes)} unpacked, more than "
            f"{megabytes(UNPACKED_BYTES)}; cut the record"
        )
    if len(set(schema.names)) < len(schema):
        raise PlantError(f"{path_text(path)}: a column name appears twice")
    for field in schema:
        kind = field.type
        taken = (types.is_integer, types.is_floating, types.is_boolean, types.is_null)
        if not any(is_one(kind) for is_one in (*taken, types.is_timestamp, types.is_date)):
            name = printable(field.name, 60)
            raise PlantError(
                f"{path_text(path)}: "
                f"column {name} holds {printable(str(kind), 60)}; expected numbers"
            )
