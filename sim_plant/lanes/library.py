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
def available() -> tuple[Lanes, ...]:
    """Return the binaries of this installation and processor, the widest first; none: numba."""
    asked = os.environ.get(VARIABLE, "")
    names = BUILDS if not asked else tuple(name for name in BUILDS if name == asked)
    found = tuple(lanes for lanes in map(loaded, names) if lanes is not None)
    return found[:-1] if len(found) > 1 and found[-1].name == "plain" else found


def widest() -> int:
    """Return how many lines run side by side at most; 1 without a binary."""
    return available()[0].width if available() else 1


def fitting(lines: int) -> Lanes | None:
    """Return the narrowest binary that takes so many lines at once, or else the widest.

    All of them give the same bits. None without a binary.
    """
    holding = [lanes for lanes in available() if lanes.width >= lines]
    return holding[-1] if holding else next(iter(available()), None)
