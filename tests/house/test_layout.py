"""Files stay short, and the formatter has its way."""

from __future__ import annotations

from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
OURS = ("aff_runtime", "sim_plant", "aff_hmi", "benchmarks", "releasing", "tests")
MOST_LINES = 400
MOST_KEPT_LAYOUTS = 20
KEEPS = "# fmt: " + "skip"


@cache
def sources() -> dict[str, list[str]]:
    """Return every file of ours with its lines."""
    paths = [path for folder in OURS for path in sorted((ROOT / folder).rglob("*.py"))]
    return {
        str(path.relative_to(ROOT)): path.read_text(encoding="utf-8").splitlines()
        for path in paths
    }


def test_no_file_of_the_product_or_the_benchmarks_is_long() -> None:
    lengths = {name: len(lines) for name, lines in sources().items()}
    assert len(lengths) > 1000
    assert not {
        name: length
        for name, length in lengths.items()
        if length > MOST_LINES and not name.startswith("tests/")
    }


def test_at_most_twenty_places_keep_a_layout_of_their_own() -> None:
    kept = [name for name, lines in sources().items() for line in lines if KEEPS in line]
    assert len(kept) <= MOST_KEPT_LAYOUTS, kept
