"""What the picture and the table of trends get: no line and no row where nothing was kept."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.aff_hmi.scripts import called


def answer(t_s: list[int], wide_s: list[int], *means: list[float | None]) -> dict[str, Any]:
    """Return an answer in which every bin goes from 1 below its mean to 2 above it."""
    curves = [
        {
            "mean": mean,
            "least": [None if v is None else v - 1 for v in mean],
            "largest": [None if v is None else v + 2 for v in mean],
        }
        for mean in means
    ]
    return {"t_s": t_s, "wide_s": wide_s, "curves": curves}


def test_the_picture_has_a_hole_where_nothing_was_kept(tmp_path: Path) -> None:
    said = answer([0, 12, 48, 60], [12] * 4, [5, 6, 7, 8])
    x, mean, least, largest = called(tmp_path, "bins", "of.holed(given[0])", said)
    assert x == [6, 18, 24, 54, 66]
    assert mean == [5, 6, None, 7, 8]
    assert least == [4, 5, None, 6, 7]
    assert largest == [7, 8, None, 9, 10]


def test_stored_minutes_in_a_finer_window_are_a_line_and_a_lack_of_some_is_a_hole(
    tmp_path: Path,
) -> None:
    """Minutes of 0 and 1, none of 2, one of 3; then memory begins 20 s into the next."""
    said = answer([0, 60, 180, 252, 264], [60, 60, 60, 12, 12], [1, 2, 3, 4, 5])
    x, mean, *_ = called(tmp_path, "bins", "of.holed(given[0])", said)
    assert x == [30, 90, 120, 210, 258, 270]
    assert mean == [1, 2, None, 3, 4, 5]


def test_a_value_without_neighbours_is_a_point(tmp_path: Path) -> None:
    values = [1, None, 2, None, 3, 4, None, 5]
    assert called(tmp_path, "bins", "of.lonely(given[0])", values) == [0, 2, 7]


@pytest.mark.parametrize("count", [7, 60, 61, 299])
def test_a_row_of_the_table_is_of_all_its_bins(tmp_path: Path, count: int) -> None:
    rng = np.random.default_rng(count)
    mean = [round(float(v), 3) for v in rng.normal(90.0, 5.0, count)]
    said = answer(list(range(0, 12 * count, 12)), [12] * count, mean)
    rows = called(tmp_path, "bins", "of.tabled(given[0], 60)", said)
    assert min(count, 31) <= len(rows) <= 60
    starts = [row["t_s"] // 12 for row in rows]
    for row, part in zip(rows, np.split(np.array(mean), starts[1:]), strict=True):
        (one,) = row["curves"]
        assert one["mean"] == pytest.approx(part.mean())
        assert (one["least"], one["largest"]) == pytest.approx((part.min() - 1, part.max() + 2))


def test_the_table_says_where_nothing_was_kept_and_leaves_out_what_was_not_known(
    tmp_path: Path,
) -> None:
    said = answer([0, 60, 72, 300], [60, 12, 12, 12], [9.0, 3.0, None, 4.0], [None] * 4)
    rows = called(tmp_path, "bins", "of.tabled(given[0], 2)", said)
    nothing = {"least": None, "mean": None, "largest": None}
    first = {"least": 2.0, "mean": (9.0 * 60 + 3.0 * 12) / 72, "largest": 11.0}
    assert rows == [
        {"t_s": 0, "curves": [first, nothing]},
        {"t_s": 84, "curves": None},
        {"t_s": 300, "curves": [{"least": 3.0, "mean": 4.0, "largest": 6.0}, nothing]},
    ]


def test_a_table_of_nothing_is_empty(tmp_path: Path) -> None:
    said = answer([], [], [])
    assert called(tmp_path, "bins", "of.tabled(given[0], 60)", said) == []
    assert called(tmp_path, "bins", "of.holed(given[0])", said) == [[], [], [], []]
