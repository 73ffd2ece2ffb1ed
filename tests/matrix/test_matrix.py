from __future__ import annotations

import pytest

from tests.matrix.cells import Cell, cells, judge


@pytest.mark.parametrize("cell", list(cells()), ids=str)
def test_every_cell_reacts_as_the_table_says(cell: Cell) -> None:
    assert judge(cell) == ""
