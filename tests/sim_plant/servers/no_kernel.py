"""For a process whose line is none of the model: it imports no numba, which takes a second."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from sim_plant.base.ports import SteppedLine

LINE = Path(__file__).parents[3] / "sim_plant" / "line"


def opened_by(open_line: Callable[..., SteppedLine]) -> None:
    """Let this process open lines by a function; call it before anything imports the model.

    The files of `sim_plant.line` are there: what reads a YAML file by one of them can.
    """
    for name, found in (
        ("sim_plant.line", {"open_line": open_line, "__path__": [str(LINE)]}),
        ("sim_plant.base.jit", {"nothing_kept": lambda: False}),
    ):
        assert name not in sys.modules
        stand_in = ModuleType(name)
        vars(stand_in).update(found)
        sys.modules[name] = stand_in
