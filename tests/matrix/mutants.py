"""``python -m tests.matrix.mutants [--docs]``: take each reaction away and see what notices.

A mutant is tried on the cells most likely to notice, then on all others of its wire, then on the
unit tests of its room. It survives when everything stays green without the reaction. The list of
survivors is the result.
"""

from __future__ import annotations

import contextlib
import io
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.matrix.cells import Cell, cells, judge
from tests.matrix.mutations import MUTANTS, Mutant, applied

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """What noticed that a reaction was gone; empty when nothing did."""

    mutant: Mutant
    by: str


def relevant(mutant: Mutant) -> Iterable[Cell]:
    """Return the mutant's own faults first, then every other cell of its wire."""
    own = [c for c in cells(mutant.states) if not mutant.wire or c.wire == mutant.wire]
    likely = [c for c in own if any(c.spec.startswith(name) for name in mutant.likely)]
    return likely + [c for c in own if c not in likely]


def notices(mutant: Mutant) -> str:
    """Return the first cell, or the unit test, that notices; empty when none does."""
    found, cell = "", None
    with applied(mutant):
        for cell in relevant(mutant):
            found = judge(cell)
            if found:
                break
        else:
            return _first_failure(mutant.tests) if mutant.tests else ""
    assert not judge(cell), f"{cell} is red without any mutant"
    return f"{cell}: {found}"


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
        arguments = ["-q", "-x", "-p", "no:cacheprovider", *(str(ROOT / p) for p in paths.split())]
        pytest.main(arguments, plugins=[first])
    return first.name


def main(arguments: list[str]) -> int:
    """Print every mutant with what kills it; 1 when one survives without a reason."""
    names = [a for a in arguments if not a.startswith("-")]
    chosen = [m for m in MUTANTS if not names or any(n in m.name for n in names)]
    left = []
    for mutant in chosen:
        found = notices(mutant)
        word = "killed" if found else ("EQUAL" if mutant.equal else "SURVIVES")
        print(f"{word:8} {mutant.name:52} {found or mutant.equal}", flush=True)
        if not found:
            left.append(mutant)
    killed = len(chosen) - len(left)
    unexplained = [mutant for mutant in left if not mutant.equal]
    print(f"{killed} of {len(chosen)} mutants killed, {len(left) - len(unexplained)} explained, "
          f"{len(unexplained)} survive")  # fmt: skip
    return 1 if unexplained else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
