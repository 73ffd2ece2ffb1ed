"""Which number of the line a change adds to, by the Python text of the compiled functions."""

from types import SimpleNamespace

import numpy as np

from sim_plant.base import arrays
from sim_plant.base.arrays import CHANGEABLE, Records
from sim_plant.line.equations import changing_numbers

TYPES = {
    "bodies": arrays.BODY,
    "spans": arrays.SPAN,
    "web": arrays.WEB,
    "drives": arrays.DRIVE,
    "cells": arrays.CELL,
    "loops": arrays.LOOP,
    "heats": arrays.HEAT,
    "carriages": arrays.CARRIAGE,
}
PLACE, MORE = 2, 0.5


def changed_by(target: int) -> dict[str, list[tuple[int, float]]]:
    """Return what of a line of zeros a change of this target makes other than 0, and where."""
    tables: dict[str, Records] = {
        name: np.zeros(1 if name == "web" else 4, dtype) for name, dtype in TYPES.items()
    }
    line = SimpleNamespace(**{name: table.view(np.recarray) for name, table in tables.items()})
    for name in TYPES:
        add = getattr(changing_numbers, f"of_{name}").py_func
        given = (target, MORE) if name == "web" else (target, PLACE, MORE)
        add(line, *given)
    return {
        f"{name}.{field}": [
            (int(at), float(table[field][at])) for at in np.flatnonzero(table[field])
        ]
        for name, table in tables.items()
        for field in table.dtype.names or ()
        if np.any(table[field])
    }


def test_each_target_adds_to_the_number_that_the_list_names_and_to_no_other() -> None:
    for target, number in enumerate(CHANGEABLE):
        place = 0 if number.startswith("web.") else PLACE
        assert changed_by(target) == {number: [(place, MORE)]}, number
