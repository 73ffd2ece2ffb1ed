"""Step 0: rights, clock, processors, and how late a tick wakes up."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import Figure, StepResult, at_least, at_most, quantile
from aff_runtime.base.machine import Machine

WAKE_LIMIT_US = 500.0
"""A tenth of a cycle of 5 ms: a stock kernel with SCHED_FIFO stays below, one without does not."""
SHORTEST_S = 59.0
"""A minute, less the second that the end of a record may still lack."""
FEWEST_PROCESSORS = 2
"""One for the control process alone, one for everything else."""
FIFO = "SCHED_FIFO"


def measure(evidence: Evidence) -> StepResult:
    """Return the wake-up's 99 % point over a minute, the rights, and the machine."""
    columns = evidence.window.table.columns
    time_s = columns["time_s"]
    seconds = float(time_s[-1] - time_s[0])
    wake, low, high = quantile(columns.get("wake_us", np.empty(0)), 0.99)
    fifo = [right.granted for right in evidence.rights if FIFO in right.text]
    refused = [right.text for right in evidence.rights if not right.granted]
    figures = [
        Figure(
            name="wake-up, 99 % point",
            value=wake,
            unit="us",
            low=low,
            high=high,
            limit=f"at most {WAKE_LIMIT_US:g} us",
            good=at_most(wake, WAKE_LIMIT_US),
        ),
        Figure(
            name="length of the window",
            value=seconds,
            unit="s",
            limit=f"at least {SHORTEST_S:g} s",
            good=at_least(seconds, SHORTEST_S),
        ),
        Figure(
            name="SCHED_FIFO granted",
            value=float(any(fifo)) if fifo else float("nan"),
            limit="1",
            good=any(fifo) if fifo else None,
        ),
    ]
    remarks = [f"right refused: {text}" for text in refused]
    if evidence.machine is not None:
        figures.append(_processors(evidence.machine))
        remarks.extend(_seen(evidence.machine))
    return StepResult(figures=tuple(figures), remarks=tuple(remarks))


def _processors(machine: Machine) -> Figure:
    count = float("nan") if machine.processors is None else float(machine.processors)
    return Figure(
        name="processors",
        value=count,
        limit=f"at least {FEWEST_PROCESSORS}",
        good=at_least(count, FEWEST_PROCESSORS),
    )


def _seen(machine: Machine) -> Iterator[str]:
    yield f"governor: {machine.governors or 'not seen'}"
    yield f"isolated processors: {machine.isolated or 'not seen'}"
    if machine.is_realtime is not None:
        yield f"real-time kernel: {'yes' if machine.is_realtime else 'no'}"
