"""Do the intervals of refine hold what they say? Drawn effects, fitted where they are, no search.

python -m benchmarks.intervals [--rounds N] [--only TEXT] [--out DIR] [--docs]

Records are the campaign's, sizes some times those it begins with. A minute a draw; rows are kept,
a stopped run goes on.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.intervals.draws import SIZES, draws
from benchmarks.intervals.fits import row_of
from benchmarks.intervals.page import document, page
from benchmarks.rows import read_row, write_row

KEYS = ("name", "effect", "numbers", "excess")
PAGE = Path("docs/results/refine-intervals.md")


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw, fit, print the table; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.intervals", description=__doc__)
    parser.add_argument("--rounds", type=int, default=len(SIZES))
    parser.add_argument("--only", default="", help="names that contain this")
    parser.add_argument("--out", type=Path, default=Path("out/intervals"))
    parser.add_argument("--docs", action="store_true", help=f"also write {PAGE}")
    given = parser.parse_args(arguments)
    rows = []
    for name, case in draws(given.rounds, given.only):
        kept = given.out / "rows" / f"{name}.json"
        row = read_row(kept, KEYS)
        if row is None:
            row = row_of(name, case, given.out / "work" / name)
            write_row(kept, row)
            sys.stderr.write(f"{name}: {len(row['numbers'])} numbers\n")
        rows.append(row)
    print(page(rows))
    if given.docs:
        PAGE.write_text(document(rows, given.rounds), encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
