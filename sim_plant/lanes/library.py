"""The lanes' binary: which of those that were built this processor runs, or none.

Without one everything goes line by line through numba, which is the reference. The binaries are
built from C that was made from the kernel's source; one that was made from other source than
what lies here is not used.
"""

from __future__ import annotations

import ctypes
import importlib.util
import os
from dataclasses import dataclass
from functools import cache

from sim_plant.base.kernel_sources import kernel_hash

VARIABLE = "SIM_PLANT_LANES"
"""``none`` leaves the binaries out; one of ``BUILDS`` takes that one or none."""
BUILDS = ("avx512", "avx2", "plain")
"""The fastest first."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Lanes:
    """One binary: its name in ``BUILDS``, how many lines it runs side by side, its functions."""

    name: str
    width: int
    functions: ctypes.CDLL


def loaded(name: str) -> Lanes | None:
    """Return a build by its name; None where it is not there, stale, or for another processor."""
    found = importlib.util.find_spec(f"sim_plant.lanes.lanes_{name}")
    if found is None or found.origin is None:
        return None
    try:
        functions = ctypes.CDLL(found.origin)
    except OSError:
        return None
    functions.line_source.restype = ctypes.c_char_p
    functions.line_works.restype = ctypes.c_bool
    functions.line_lanes.restype = ctypes.c_int64
    if functions.line_source() != kernel_hash().encode() or not functions.line_works():
        return None
    return Lanes(name=name, width=int(functions.line_lanes()), functions=functions)


@cache
def chosen() -> Lanes | None:
    """Return the fastest binary of this installation and processor; None: line by line."""
    asked = os.environ.get(VARIABLE, "")
    names = BUILDS if not asked else tuple(name for name in BUILDS if name == asked)
    return next((lanes for lanes in map(loaded, names) if lanes is not None), None)
