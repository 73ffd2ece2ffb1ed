"""A part of one line's kernel as C: for whoever needs a few of its entries."""

from __future__ import annotations

from pathlib import Path

from sim_plant.codegen.target import EntryPoint, Target
from sim_plant.codegen.write import translated

_PRELUDE = Path(__file__).parent / "prelude_scalar.h"


def entries_source(*names: str) -> str:
    """Return the C99 of these entries and of all that they reach; see ``write.scalar_source``."""
    target = Target(entries=tuple(EntryPoint(name=name) for name in names))
    return translated(target, _PRELUDE.read_text())
