"""The catalogue holds every experiment of the list, and each quick one keeps its promises."""

from pathlib import Path

import pytest

from sim_plant.reproduce.catalogue import BY_IDENTITY, CATALOGUE
from sim_plant.reproduce.entry import Result

LIST = {
    2: "2.2.2 2.5 T2.2 2.45 2.7 2.8 2.9 2.10 2.11",
    3: "3.10 3.6 3.7 3.8",
    4: "4.1 4.14 4.38 4.40 4.11 4.46",
    5: "5.1 5.4 5.6 5.7 5.9 5.12 5.13 5.14 5.15",
    6: "6.pendulum 6.linear 6.accumulator 6.thermal 6.sampling 6.speed",
}
QUICK = ("2.2.2", "2.5", "T2.2", "3.10", "4.1", "4.14", "4.38", "4.40", "6.accumulator")


def test_every_experiment_of_the_list_is_there_once() -> None:
    assert [e.identity for e in CATALOGUE if e.chapter == 2] == LIST[2].split()
    for chapter, names in LIST.items():
        assert {e.identity for e in CATALOGUE if e.chapter == chapter} == set(names.split())
    assert len(BY_IDENTITY) == len(CATALOGUE)


long = pytest.mark.long
"""They compute for 5 s; quick: single figures of some, test_experiments.py."""


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    return {identity: BY_IDENTITY[identity].run() for identity in QUICK}


@long
@pytest.mark.parametrize("identity", QUICK)
def test_has_figure_numbers_and_kept_promises(identity: str, results: dict[str, Result]) -> None:
    found = results[identity]
    assert found.rows
    assert all(figure.startswith("<svg") for figure in found.figures)
    assert found.figures
    assert [g.what for g in found.disagreements if not g.within] == []


def value(results: dict[str, Result], identity: str, start: str) -> float:
    (row,) = [r for r in results[identity].rows if r.quantity.startswith(start)]
    return row.ours


@long
def test_corrected_formulas_meet_the_exact_tangent_below_ten_nanometres(
    results: dict[str, Result],
) -> None:
    for identity in ("3.10", "4.1", "4.14"):
        lengths = [g for g in results[identity].disagreements if "length" in g.what]
        assert len(lengths) >= 4
        assert max(g.difference for g in lengths) < 1e-8


@long
@pytest.mark.parametrize(
    ("identity", "row", "expected", "tolerance"),
    [
        ("T2.2", "c, divisor 7", 0.01265, 5e-6),
        ("T2.2", "b, divisor 7", 1.010e-4, 1e-7),
        ("T2.2", "c, divisor 6", 0.01476, 5e-6),
        ("T2.2", "b, divisor 6", 1.18e-4, 5e-7),
        ("3.10", "arm error with cos", 3.9e-3, 5e-5),
        ("4.40", "y at the edge", 3.97, 5e-3),
        ("4.40", "the same with the maxima at the corners, flat", 0.056, 5e-4),
        ("4.40", "the same with the maxima at the corners, sides", 0.20, 5e-3),
        ("4.14", "slope at the maximum", 1.0, 1e-12),
    ],
)
def test_numbers_are_those_of_the_independent_check(
    results: dict[str, Result], identity: str, row: str, expected: float, tolerance: float
) -> None:
    assert value(results, identity, row) == pytest.approx(expected, abs=tolerance)


def test_the_documented_table_holds_every_experiment() -> None:
    table = (Path(__file__).parents[3] / "docs" / "results" / "reproduction.md").read_text(
        encoding="utf-8"
    )
    headings = [line.split()[1] for line in table.splitlines() if line.startswith("### ")]
    assert headings == [e.identity for e in CATALOGUE]
    assert "BROKEN" not in table
