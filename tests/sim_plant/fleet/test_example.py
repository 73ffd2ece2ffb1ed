"""Virtual lines: what is drawn, what a stopped example does, and the table in DuckDB."""

from __future__ import annotations

import math
import re
from collections import Counter
from dataclasses import replace
from pathlib import Path

import duckdb
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.fleet import example
from sim_plant.fleet.findings import Finding, write_parquet

PAGE = Path(__file__).parents[3] / "docs" / "engineer" / "fleet.md"
QUERIES = re.findall(r"```sql\n(.*?)```", PAGE.read_text(), re.DOTALL)


@pytest.mark.long  # 24 draws; quick: one, above
def test_lines_differ_in_web_and_effect_and_about_three_in_ten_are_healthy() -> None:
    lines = [example.drawn(1, number) for number in range(1, 25)]
    assert len({text for text, _ in lines}) == 24
    kinds = Counter(effect.effect if effect else "" for _, effect in lines)
    spread = 4.0 * math.sqrt(24 * 0.3 * 0.7)  # of a binomial draw
    assert abs(kinds.pop("") - 0.3 * 24) < spread
    assert len(kinds) > 8
    assert set(kinds) <= set(BY_NAME)


def test_a_line_is_drawn_by_its_number_and_the_seed_alone() -> None:
    assert example.drawn(1, 7) == example.drawn(1, 7)
    assert example.drawn(1, 7) != example.drawn(2, 7)


def test_a_stopped_example_goes_on_and_says_what_each_line_hides(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(example, "DURATION_S", 0.5)
    lines, runs = tmp_path / "lines", tmp_path / "runs"
    said: list[str] = []
    hidden = example.write_fleet(1, 1, lines, runs, said.append)
    records = sorted(path.name for path in (runs / "line0001").glob("*.csv.gz"))
    assert records == ["2026-09-28_a.csv.gz", "2026-09-28_b.csv.gz"]
    assert said == [f"{name}: {what or 'healthy'}" for name, what in hidden.items()]
    whole = {path: path.read_bytes() for path in runs.rglob("*.csv.gz")}
    first, *others = sorted(whole)
    first.unlink()
    stamps = {path: path.stat().st_mtime_ns for path in others}
    assert example.write_fleet(1, 1, lines, runs, said.append) == hidden
    assert first.exists()
    assert {path: path.stat().st_mtime_ns for path in others} == stamps


def found(line: str, **more: object) -> Finding:
    plain = Finding(line=line, recorded="2026-11-20", verdict="traced")
    return replace(plain, **more)


@pytest.fixture
def table(tmp_path: Path) -> Path:
    """Return a table of four lines on two days."""
    sure = {"sure": "named"}
    left = {"sure": "named", "error_after": 2.5}
    rows = [
        found("film1", effect="slip", place="R3", size=2e-3, trend=4e-4, error_before=3.0, **sure),
        found("film2", effect="eccentric_roller", place="R6", size=1e-4, error_before=9.0, **left),
        found("film2", effect="slip", place="R3", size=3e-3, error_before=9.0),
        found("film3", verdict="nothing", error_before=1.0),
        found("film4", verdict="failed", recorded="2026-11-21", to_do="film4.yaml: no roller R9"),
    ]
    write_parquet(rows, tmp_path / "fleet.parquet")
    return tmp_path


@pytest.mark.parametrize(
    ("number", "rows"),
    [
        (0, [("film2", "eccentric_roller"), ("film2", "slip"), ("film1", "slip")]),
        (1, [("slip", 2, 2.5e-3), ("eccentric_roller", 1, 1e-4)]),
        (2, [("film1", "slip", "R3", 4e-4)]),
        (3, [("film2", "eccentric_roller", "R6", 9.0, 2.5)]),
        (4, [("film4", "film4.yaml: no roller R9")]),
    ],
)
def test_duckdb_answers_the_queries_of_the_page(
    number: int, rows: list[tuple[object, ...]], table: Path
) -> None:
    assert len(QUERIES) == 5
    asked = QUERIES[number].replace("DIR/", f"{table}/")
    answers = duckdb.sql(asked).fetchall()
    assert [row[: len(rows[0])] for row in answers] == rows
