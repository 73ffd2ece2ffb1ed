from __future__ import annotations

import pytest

from tests.matrix.cells import Cell, cells, judge


# the other states: make matrix
@pytest.mark.parametrize("cell", list(cells(("OFF", "ACTIVE"))), ids=str)
def test_every_cell_reacts_as_the_table_says(cell: Cell) -> None:
    assert judge(cell) == ""
