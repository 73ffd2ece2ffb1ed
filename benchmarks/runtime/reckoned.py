"""Cycles that smaller gateways carry, reckoned from the instructions of a tick."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.runtime.facts import FactRow, Section
from benchmarks.runtime.instructions import TITLE as COUNTED
from benchmarks.runtime.targets import HOT, PACED, figure, find

TITLE = "Cycles that smaller gateways carry, reckoned"
RATES_G = (0.3, 1.0, 3.0)  # instructions per second, 1e9
CYCLES_MS = (1, 2, 5, 10, 20, 50, 100)
SHARE = 0.5  # of the cycle, for what is counted
NOTE = (
    "Reckoned, not measured on such a box: a tick takes N / R, and the shortest cycle of "
    f"{', '.join(map(str, CYCLES_MS))} ms that is at least {1 / SHARE:g} N / R is carried. "
    "N: instructions per tick, above, of the line there; more orders and actuators cost more. R: "
    "instructions per second of one core in user space, clock times instructions per cycle, of "
    "ticks with a sleep between them, which find caches cold: {paced}. The other half of the "
    "cycle is for what N leaves out: kernel and PLC in the exchange, wake-up, ticks longer than "
    "the mean."
)


def reckoned(sections: Sequence[Section]) -> Section | None:
    """Return the table of a run that counted instructions; None of another one."""
    rows = []
    for way in ("compiled", "numpy"):
        row = find(sections, COUNTED, f"all, by {way}")
        if row is not None:
            thousand = figure(row, "")
            rows += [_row(way, thousand * 1e3, rate * 1e9) for rate in RATES_G]
    note = NOTE.format(paced=_paced(sections))
    return Section(title=TITLE, note=note, rows=tuple(rows), head="reckoned") if rows else None


def _paced(sections: Sequence[Section]) -> str:
    """Return how much longer a tick of the law takes that is waited for."""
    row = "16 orders by compiled"
    hot, paced = (find(sections, title, row) for title in (HOT, PACED))
    if hot is None or paced is None:
        return "longer than back to back"
    ratio = figure(paced, "p50") / figure(hot, "p50")
    return f"the law above takes {ratio:.1f} times as long as back to back"


def _row(way: str, instructions: float, per_second: float) -> FactRow:
    tick_ms = 1e3 * instructions / per_second
    carried = carried_ms(instructions, per_second)
    return FactRow(
        name=f"R = {per_second * 1e-9:g} G/s, by {way}",
        value=f"{tick_ms:.2f} ms a tick",
        remark=f"carries {carried} ms" if carried else f"carries no {CYCLES_MS[-1]} ms",
    )


def carried_ms(instructions: float, per_second: float) -> int | None:
    """Return the shortest cycle of which a tick takes its share, ms; None when there is none."""
    least_ms = 1e3 * instructions / per_second / SHARE
    return next((ms for ms in CYCLES_MS if ms >= least_ms), None)
