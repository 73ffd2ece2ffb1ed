"""Time of the law's tick for 1, 16 and 64 blocks, paced at 5 ms as on a line."""

from __future__ import annotations

from benchmarks.runtime.facts import FactRow, Section, quantiles_us, timing_row
from benchmarks.runtime.paced import PERIOD_NS, in_child

BLOCKS = (1, 16, 64)


def law_time(seconds: float) -> Section:
    """Measure each number of blocks for ``seconds``; all of them adapt in every tick."""
    rows: list[FactRow] = []
    medians: list[float] = []
    for blocks in BLOCKS:
        work_ns = in_child("law", str(blocks), str(seconds))["work_ns"]
        medians.append(quantiles_us(work_ns)[0])
        share = quantiles_us(work_ns)[1] * 1e3 / PERIOD_NS
        rows.append(timing_row(f"{blocks} blocks", work_ns, f"p99 is {share:.1%} of the cycle"))
    growth = f"{medians[-1] / medians[0]:.1f} times the median for {BLOCKS[-1]} times the blocks"
    rows.append(FactRow(name="ratio", value=growth))
    return Section(
        title="Tick of the law",
        note=f"{seconds:g} s each, 16 orders per roll, every block adapts, telemetry included.",
        rows=tuple(rows),
    )
