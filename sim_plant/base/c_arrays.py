"""Arrays and named tuples as the structs that translated C takes: pointers and lengths."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np


class CVector(ctypes.Structure):
    """An array of one axis: numbers, or records."""

    _fields_ = (("at", ctypes.c_void_p), ("n", ctypes.c_int64))


class CMatrix(ctypes.Structure):
    """An array of two axes, row by row."""

    _fields_ = (("at", ctypes.c_void_p), ("rows", ctypes.c_int64), ("cols", ctypes.c_int64))


def c_array(array: np.ndarray[Any, Any], axes: int) -> CVector | CMatrix:
    """Return an array as C takes it; axes behind the first ``axes`` belong to the element.

    The array must live as long as what is returned is used.

    Raises
    ------
    ValueError
        When the array has gaps, or other than one or two axes.
    """
    if not array.flags.c_contiguous or axes not in (1, 2):
        raise ValueError(f"an array of {axes} axes without gaps wanted, found {array.shape}")
    return (CVector if axes == 1 else CMatrix)(array.ctypes.data, *array.shape[:axes])


def c_struct(
    values: NamedTuple, axes: Mapping[str, int] = MappingProxyType({})
) -> ctypes.Structure:
    """Return a named tuple of arrays and whole numbers as a C struct of the same fields.

    ``axes`` : number of axes of a field where the last ones belong to the element. The arrays
    must live as long as what is returned is used.
    """
    parts: list[Any] = []
    for name, value in values._asdict().items():
        if isinstance(value, np.ndarray):
            parts.append(c_array(value, axes.get(name, value.ndim)))
        else:
            parts.append(ctypes.c_int64(value))
    fields = [(name, type(part)) for name, part in zip(values._fields, parts, strict=True)]
    made = type(type(values).__name__, (ctypes.Structure,), {"_fields_": fields})
    return made(*parts)  # type: ignore[no-any-return]
