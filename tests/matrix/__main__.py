"""``python -m tests.matrix [--docs]``: run every cell and print the matrix.

With ``--docs`` the table also goes between its marks in ``docs/results/fault-matrix.md``.
"""

from __future__ import annotations

import argparse
import sys
from collections import defaultdict
from pathlib import Path

from tests.matrix.cells import STATES, cells, judge

PAGE = Path(__file__).parents[2] / "docs" / "results" / "fault-matrix.md"
BEGIN, END = "<!-- matrix: begin -->\n", "<!-- matrix: end -->\n"
Found = dict[tuple[str, str], dict[str, str]]


def main(arguments: list[str]) -> int:
    """Print one row per fault and wire; 0 when every cell is green."""
    parser = argparse.ArgumentParser(prog="python -m tests.matrix", description=__doc__)
    parser.add_argument("--docs", action="store_true", help=f"write the table to {PAGE.name}")
    options = parser.parse_args(arguments)
    found: Found = defaultdict(dict)
    wanted: dict[tuple[str, str], str] = {}
    for cell in cells():
        found[(cell.fault, cell.wire)][cell.state] = judge(cell)
        wanted[(cell.fault, cell.wire)] = cell.reaction
    print(f"{'fault':42} {'wire':8} {'required':8} " + " ".join(f"{s:10}" for s in STATES))
    for (fault, wire), states in found.items():
        shown = " ".join(f"{_word(states[s]):10}" for s in STATES)
        print(f"{fault:42} {wire:8} {wanted[(fault, wire)]:8} {shown}".rstrip())
        for state, wrong in states.items():
            if wrong:
                print(f"    {state}: {wrong}")
    total = sum(len(states) for states in found.values())
    bad = sum(bool(wrong) for states in found.values() for wrong in states.values())
    verdict = f"{total - bad} of {total} cells green"
    print(verdict)
    if options.docs:
        write(found, wanted, verdict)
    return 1 if bad else 0


def write(found: Found, wanted: dict[tuple[str, str], str], verdict: str) -> None:
    """Put the table between its marks on the page."""
    rows = [
        f"`python -m tests.matrix --docs`: {verdict}.\n",
        "| fault | wire | required | " + " | ".join(STATES) + " |",
        "|---" * (3 + len(STATES)) + "|",
    ]
    for (fault, wire), states in found.items():
        shown = " | ".join(_word(states[s]) for s in STATES)
        rows.append(f"| {fault} | {wire} | {wanted[(fault, wire)]} | {shown} |")
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    after = rest.partition(END)[2]
    PAGE.write_text(before + BEGIN + "\n".join(rows) + "\n" + END + after, encoding="utf-8")


def _word(wrong: str) -> str:
    return "RED" if wrong else "green"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
