"""``python -m tests.matrix.mutants [NAME ...]``: take each reaction away and see what notices.

A mutant is tried on the cells most likely to notice, then on the unit tests of its room, then on
all other cells of its wire. It survives when everything stays green without the reaction. The
list of survivors is the result.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import sys
from pathlib import Path

import pytest

from tests.matrix.cells import Cell, cells, judge
from tests.matrix.mutations import MUTANTS, Mutant, applied

ROOT = Path(__file__).parents[2]
LOADED = "ignore::pytest.PytestAssertRewriteWarning"
"""The installed plugin's package is there already: the mutants were made in it."""


def notices(mutant: Mutant) -> str:
    """Return what notices: a likely cell, a unit test, any other cell; empty when nothing does."""
    own = [c for c in cells(mutant.states) if not mutant.wire or c.wire == mutant.wire]
    likely = [c for c in own if c.spec.startswith(mutant.likely)]
    found = _first_red(mutant, likely)
    if not found and mutant.tests:
        with applied(mutant):
            found = _first_failure(mutant.tests)
    return found or _first_red(mutant, [c for c in own if c not in likely])


def _first_red(mutant: Mutant, tried: list[Cell]) -> str:
    """Return the first cell that turns red without the reaction, and is green with it."""
    for cell in tried:
        with applied(mutant):
            found = judge(cell)
        if found:
            assert not judge(cell), f"{cell} is red without any mutant"
            return f"{cell}: {found}"
    return ""


class _First:
    """Remembers the first test that failed."""

    def __init__(self) -> None:
        self.name = ""

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Take one report."""
        if report.failed and not self.name:
            self.name = report.nodeid


def _first_failure(paths: str) -> str:
    first = _First()
    with contextlib.redirect_stdout(io.StringIO()):
        plain = ["-q", "-x", "-p", "no:cacheprovider", "-W", LOADED]
        arguments = [*plain, *(str(ROOT / p) for p in paths.split())]
        pytest.main(arguments, plugins=[first])
    return first.name


def main(arguments: list[str]) -> int:
    """Print every mutant with what kills it; 1 when one survives without a reason."""
    parser = argparse.ArgumentParser(prog="python -m tests.matrix.mutants", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help="part of a mutant's name")
    names = parser.parse_args(arguments).names
    chosen = [m for m in MUTANTS if not names or any(n in m.name for n in names)]
    if not chosen:
        parser.error(f"no mutant is called {' or '.join(names)}")
    left = []
    for mutant in chosen:
        found = notices(mutant)
        word = "killed" if found else ("EQUAL" if mutant.equal else "SURVIVES")
        print(f"{word:8} {mutant.name:52} {found or mutant.equal}", flush=True)
        if not found:
            left.append(mutant)
    killed = len(chosen) - len(left)
    unexplained = [mutant for mutant in left if not mutant.equal]
    print(
        f"{killed} of {len(chosen)} mutants killed, {len(left) - len(unexplained)} explained, "
        f"{len(unexplained)} survive"
    )
    return 1 if unexplained else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
