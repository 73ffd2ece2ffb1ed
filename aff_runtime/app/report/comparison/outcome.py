"""What a comparison comes to, in sentences: which orders fell, which grew, what is not told."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from aff_runtime.app.report.comparison.comparing import Comparison, OrderRow
from aff_runtime.app.report.comparison.turns import Change

MOST_NAMED = 5
"""Orders of one direction that are named, the largest change in newton first."""

NO_CHANGE = {"none": "both in the noise", "unknown": "change not known"}
"""What is said of a change without a figure, by its ``bound``."""


def outcome(comparison: Comparison) -> Iterator[str]:
    """Yield the sentences; each order of a roll once, in the tension in which it changed most."""
    by_order: dict[tuple[str, int], list[OrderRow]] = {}
    for row in comparison.rows:
        by_order.setdefault((row.roll, row.order), []).append(row)
    fell, grew = (
        [moved for rows in by_order.values() if (moved := _moved(rows, sign))] for sign in (-1, 1)
    )
    for what, found in (("fell", fell), ("grew", grew)):
        yield from _named(what, found)
    told = {(rows[0].roll, rows[0].order) for rows in (*fell, *grew)}
    if by_order:
        yield (
            f"of {len(by_order)} orders {len(by_order) - len(told)} did not change beyond their "
            "interval or are in the noise; by chance one figure in 20 that did not change is told"
        )
    if comparison.labels or any(window.labels for window in comparison.windows):
        yield "read with care: what the windows lack, or in what they differ, is said beside"


def direction(row: OrderRow) -> int:
    """Return 1 where an order grew for sure, -1 where it fell, 0 where that is not told."""
    change = row.change
    if change.low_dB > 0.0:  # false of what is not known
        return 1
    return -1 if change.high_dB < 0.0 else 0


def _moved(rows: Sequence[OrderRow], sign: int) -> list[OrderRow]:
    """Return the rows of one order that went this way, the largest change first."""
    return sorted((row for row in rows if direction(row) == sign), key=_newton, reverse=True)


def _newton(row: OrderRow) -> float:
    size = abs(row.after.amplitude - row.before.amplitude)
    return size if math.isfinite(size) else 0.0


def _named(what: str, found: Sequence[Sequence[OrderRow]]) -> Iterator[str]:
    largest_first = sorted(found, key=lambda rows: _newton(rows[0]), reverse=True)
    for first, *others in largest_first[:MOST_NAMED]:
        also = f"; in {len(others)} more of the tensions too" if others else ""
        yield (
            f"{what}: {first.roll} {first.order}x in {first.signal} "
            f"from {first.before.amplitude:.3g} to {first.after.amplitude:.3g} N, "
            f"{change_text(first.change)}{also}"
        )
    if len(largest_first) > MOST_NAMED:
        yield f"{what}: {len(largest_first) - MOST_NAMED} more orders, by less"
    if not largest_first:
        yield f"{what}: no order beyond its interval"


def change_text(change: Change) -> str:
    """Return a change with its interval, or the bound that it is."""
    if change.bound in NO_CHANGE:
        return NO_CHANGE[change.bound]
    if change.bound:
        return f"{'<=' if change.bound == 'at_most' else '>='} {change.value_dB:+.1f} dB"
    if math.isnan(change.low_dB):
        return f"{change.value_dB:+.1f} dB"
    return f"{change.value_dB:+.1f} dB ({change.low_dB:+.1f} to {change.high_dB:+.1f})"
