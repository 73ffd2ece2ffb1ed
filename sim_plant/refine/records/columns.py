"""What the readers of Parquet and MDF share: headers, numbers, packages."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from sim_plant.base.arrays import Array
from sim_plant.refine.records.limits import check_name, path_text

Table = tuple[dict[str, Array], list[str]]
"""Columns by header, and what is to be said about them."""


def header_of(path: Path, taken: Mapping[str, Array], name: str, unit: str) -> str:
    """Return name and unit as one header; PlantError when it is taken."""
    header = f"{name} [{unit}]" if unit else name  # a unit of its own counts, not one in the name
    check_name(path, header)
    if header in taken:
        said = printable(header, 60)
        raise PlantError(f"{path_text(path)}: a column name appears twice: {said}")
    return header


def numbers(path: Path, name: str, values: Any) -> Array:
    """Return one column as doubles (samples,); PlantError when it holds other things."""
    found = np.asarray(values)
    said = printable(name, 60)
    if found.dtype.kind not in "fiub":
        kind = printable(str(found.dtype), 60)
        raise PlantError(f"{path_text(path)}: column {said} holds {kind}; expected numbers")
    if found.ndim != 1:
        raise PlantError(
            f"{path_text(path)}: column {said} holds arrays of shape {found.shape[1:]}; "
            "expected numbers"
        )
    return np.asarray(found, dtype=np.float64)


def module_of_extra(path: Path, module: str, package: str) -> Any:
    """Return a module of the extra ``records``; PlantError when it is not there."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise PlantError(
            f"{path_text(path)}: needs {package}, of the extra records: pip install {package}"
        ) from error
