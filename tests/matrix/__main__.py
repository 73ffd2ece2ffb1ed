"""``python -m tests.matrix``: run every cell and print the matrix."""

from __future__ import annotations

import sys
from collections import defaultdict

from tests.matrix.cells import STATES, cells, judge


def main() -> int:
    """Print one row per fault; 0 when every cell is green."""
    found: dict[tuple[str, str], dict[str, str]] = defaultdict(dict)
    wanted: dict[tuple[str, str], str] = {}
    total = bad = 0
    for cell in cells():
        wrong = judge(cell)
        total, bad = total + 1, bad + bool(wrong)
        found[(cell.fault, cell.wire)][cell.state] = wrong
        wanted[(cell.fault, cell.wire)] = cell.reaction
    print(f"{'fault':42} {'wire':8} {'required':8} " + " ".join(f"{s:10}" for s in STATES))
    for (fault, wire), states in found.items():
        shown = " ".join(f"{'RED' if states[s] else 'green':10}" for s in STATES)
        print(f"{fault:42} {wire:8} {wanted[(fault, wire)]:8} {shown}".rstrip())
        for state, wrong in states.items():
            if wrong:
                print(f"    {state}: {wrong}")
    print(f"{total - bad} of {total} cells green")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
