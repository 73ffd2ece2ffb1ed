"""Step 5: in shadow the plug is pulled: after how long is it PLC_STALE, and the base reference."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from aff_runtime.app.card.evidence import Evidence
from aff_runtime.app.card.figures import NAN, Figure, StepResult, at_most
from aff_runtime.app.report.comparison.window import Window
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import State

LIMIT_MS = 300.0
BASE = "base_reference"
TYPED = (BASE,)
STALE = float(BY_NAME["PLC_STALE"].code)


def measure(evidence: Evidence) -> StepResult:
    """Return the time from the heartbeat's last movement to the fault, and both bounds."""
    freshness = evidence.site.freshness
    window = evidence.window
    time_s = window.table.columns["time_s"]
    cycle_ms = 1e3 * float(np.median(np.diff(time_s))) if time_s.size > 1 else NAN
    stale_ms, was_shadow = stale_after_ms(window)
    typed_ms = 1e3 * evidence.typed.number(BASE, "s")
    allowed_ms = freshness.fault_after_ms + 2.0 * evidence.site.line.cycle_ms
    total_ms = freshness.fault_after_ms + freshness.fade_ms
    figures = (
        Figure(
            name="PLC_STALE after the heartbeat's last movement",
            value=stale_ms,
            unit="ms",
            low=stale_ms - cycle_ms,
            high=stale_ms + cycle_ms,
            limit=f"at most {allowed_ms:g} ms (fault_after_ms and two cycles)",
            good=at_most(stale_ms, allowed_ms),
        ),
        Figure(
            name="fault_after_ms + fade_ms",
            value=total_ms,
            unit="ms",
            limit=f"at most {LIMIT_MS:g} ms",
            good=at_most(total_ms, LIMIT_MS),
        ),
        Figure(
            name="base reference at the drive after (typed)",
            value=typed_ms,
            unit="ms",
            limit=f"at most {LIMIT_MS:g} ms",
            good=at_most(typed_ms, LIMIT_MS),
        ),
    )
    return StepResult(figures=figures, missing=tuple(_missing(stale_ms, typed_ms, was_shadow)))


def stale_after_ms(window: Window) -> tuple[float, bool]:
    """Return the time to the last PLC_STALE of a window, ms, and whether it came in shadow.

    Equation: time of the first row with the alarm, less that of the last row before it whose
    readings are fresh: then the PLC's heartbeat had moved.
    """
    columns = window.table.columns
    time_s, alarm = columns["time_s"], columns["alarm"] == STALE
    begins = np.flatnonzero(alarm & ~np.concatenate([[True], alarm[:-1]]))
    if not begins.size:
        return NAN, False
    at = int(begins[-1])
    moved = np.flatnonzero(columns["fresh"][:at] > 0.0)
    if not moved.size:
        return NAN, False
    return 1e3 * float(time_s[at] - time_s[moved[-1]]), columns["state"][at - 1] == State.SHADOW


def _missing(stale_ms: float, typed_ms: float, was_shadow: bool) -> Iterator[str]:
    if not math.isfinite(stale_ms):
        yield "no PLC_STALE begins in the window: pull the plug while it is recorded"
    elif not was_shadow:
        yield "the plug was not pulled in shadow"
    if not math.isfinite(typed_ms):
        yield f"type when the PLC showed the base reference: {BASE}=200 ms"
