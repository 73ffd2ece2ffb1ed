"""One variable of an FMU."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Literal

Causality = Literal["independent", "input", "output", "parameter", "local"]
Variability = Literal["continuous", "discrete", "fixed", "tunable", "constant"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Variable:
    """What an importer shows and sets.

    Attributes
    ----------
    unit : a name of ``units.UNITS``; empty for what is not real.
    start : value that it has unless it is set; None where the line computes it.
    low, high : what may be set, inclusive.
    shown : in the display unit of its unit, where that has one.
    place : C member of ``line_memory`` that holds it.
    """

    name: str
    description: str
    causality: Causality
    variability: Variability
    place: str
    kind: Literal["real", "integer", "truth"] = "real"
    unit: str = ""
    start: float | None = None
    low: float = -math.inf
    high: float = math.inf
    shown: bool = True

    @property
    def when(self) -> str:
        """When an importer may set it, as the C table says it."""
        if self.causality not in ("input", "parameter"):
            return "SET_NEVER"
        return "SET_BEFORE" if self.variability == "fixed" else "SET_ALWAYS"


def quoted(name: str) -> str:
    """Return a name of a line file as the convention of structured names has it."""
    if re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name):
        return name
    return "'" + re.sub(r"['\\]", lambda found: "\\" + found.group(), name) + "'"
