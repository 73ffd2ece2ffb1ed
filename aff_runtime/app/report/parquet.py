"""Tables as Parquet files that DuckDB and pandas read as they are; units in the fields' metadata.

pyarrow comes with the extra ``records``: the gateway's own install does without.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Literal, get_type_hints

import numpy as np
from numpy.typing import DTypeLike, NDArray

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.files import replace_bytes
from aff_runtime.base.printable import printable

Kind = Literal["number", "whole", "text", "truth", "moment"]
Columns = dict[str, NDArray[Any]]
UNIT, ABSENT = "unit", "absent"
"""Metadata of a row's field: its unit; what a table that an earlier release wrote has of it."""
EXTRA = 'pip install "aff-runtime[records]"'
_DTYPES: Mapping[Kind, DTypeLike] = {
    "number": np.float64,
    "whole": np.int64,
    "text": np.object_,
    "truth": np.bool_,
    "moment": "datetime64[us]",
}
_KINDS: Mapping[type, Kind] = {
    float: "number",
    int: "whole",
    str: "text",
    bool: "truth",
    np.datetime64: "moment",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """One column: its name, what it holds, and its unit (empty: it has none).

    A moment is UTC. A number that is not known is NaN. ``absent`` : what rows of a table without
    this column have; None: every table has it.
    """

    name: str
    kind: Kind = "number"
    unit: str = ""
    absent: float | None = None


def empty(columns: Sequence[Field]) -> Columns:
    """Return a table without rows."""
    return {c.name: np.empty(0, dtype=_DTYPES[c.kind]) for c in columns}


def fields_of(row: type) -> tuple[Field, ...]:
    """Return the columns of a table whose rows are of this dataclass, with the fields' units."""
    kinds = get_type_hints(row)
    return tuple(
        Field(
            name=one.name,
            kind=_KINDS[kinds[one.name]],
            unit=one.metadata.get(UNIT, ""),
            absent=one.metadata.get(ABSENT),
        )
        for one in fields(row)
    )


def table(columns: Sequence[Field], rows: Sequence[object]) -> Columns:
    """Return rows as columns; every row has an attribute per column."""
    return {
        c.name: np.array([getattr(row, c.name) for row in rows], dtype=_DTYPES[c.kind])
        for c in columns
    }


def write_parquet(
    path: Path, layout: Sequence[Field], columns: Columns, about: Mapping[str, str]
) -> None:
    """Replace a file by this table, whole or not at all; ``about`` goes into its metadata.

    Raises
    ------
    ConfigError
        pyarrow is not there, or the file cannot be written.
    """
    pyarrow, parquet = _library()
    kinds = {
        "number": pyarrow.float64(),
        "whole": pyarrow.int64(),
        "text": pyarrow.string(),
        "truth": pyarrow.bool_(),
        "moment": pyarrow.timestamp("us", tz="UTC"),
    }
    schema = pyarrow.schema(
        [pyarrow.field(c.name, kinds[c.kind], metadata=_metadata(c)) for c in layout],
        metadata=dict(about),
    )
    arrays = [pyarrow.array(columns[c.name], type=kinds[c.kind]) for c in layout]
    into = pyarrow.BufferOutputStream()
    parquet.write_table(pyarrow.Table.from_arrays(arrays, schema=schema), into)
    try:
        replace_bytes(path, into.getvalue().to_pybytes())
    except OSError as error:
        reason = error.strerror or error
        raise ConfigError(f"{path}: cannot be written ({reason}); nothing is changed") from None


def _metadata(column: Field) -> Mapping[str, str] | None:
    return {UNIT: column.unit} if column.unit else None


def read_parquet(path: Path, layout: Sequence[Field]) -> tuple[Columns, dict[str, str]]:
    """Return a table that ``write_parquet`` wrote, and what its metadata say.

    Raises
    ------
    ConfigError
        pyarrow is not there, or the file is not Parquet or lacks a column.
    """
    pyarrow, parquet = _library()
    try:
        table = parquet.read_table(path)
        about = {k.decode(): v.decode() for k, v in (table.schema.metadata or {}).items()}
        columns = {c.name: _column(table, c) for c in layout}
    except PermissionError:
        raise ConfigError(f"{path}: you may not read it; nothing is wrong with it") from None
    except (OSError, KeyError, ValueError, TypeError, pyarrow.lib.ArrowException) as error:
        raise ConfigError(
            f"{path}: cannot be read ({printable(str(error), 200)}); expected a table of "
            f"{len(layout)} columns that this release wrote. Move it away to begin anew"
        ) from None
    return columns, about


def _column(table: Any, field: Field) -> NDArray[Any]:
    if field.absent is not None and field.name not in table.column_names:
        return np.full(table.num_rows, field.absent, dtype=_DTYPES[field.kind])
    column = table.column(field.name)
    if field.kind == "moment":
        column = column.cast("timestamp[us]")
    found: NDArray[Any] = column.to_numpy()
    return found.astype(_DTYPES[field.kind])


def _library() -> tuple[Any, Any]:
    try:
        import pyarrow  # noqa: PLC0415 - an extra, for this alone
        import pyarrow.parquet  # noqa: PLC0415
    except ImportError:
        raise ConfigError(f"Parquet files need pyarrow: {EXTRA}") from None
    return pyarrow, pyarrow.parquet
