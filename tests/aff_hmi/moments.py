"""Moments of a line for tests of the screen, without a service."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from aff_hmi.recent_window import RecentWindow
from aff_hmi.watch import Observed
from aff_runtime.app.door.messages import Facts
from aff_runtime.app.report.line_facts import LineFacts, OutputFacts, RollFacts
from aff_runtime.app.report.status_answer import ComingMeeting, StatusAnswer
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.signals import State
from aff_runtime.core.monitor import OrderState
from aff_runtime.telemetry.recorder_messages import RecorderReport

LINE = LineFacts(
    cycle_s=0.005,
    hold_after_s=0.015,
    fault_after_s=0.08,
    speed="line_speed_m_s",
    permissives=("WEB_INTACT",),
    references=("tension_ref_N",),
    outputs=(
        OutputFacts(
            actuator="unwind",
            column="unwind_m_s",
            unit="m/s",
            limit=0.15,
            signal="unwind_tension_N",
            reference="tension_ref_N",
        ),
    ),
    rolls=(RollFacts(name="unwind", radius_channel="unwind_radius_m"),),
)
MEETING = ComingMeeting(
    actuator="unwind",
    time_s=720.0,
    roll="unwind",
    order=4,
    other_roll="swrap",
    other_order=1,
    radius_m=0.154,
)


def row(state: State = State.ACTIVE, **more: float) -> dict[str, float]:
    """Return one row of the ring: two orders, before 3 and 4 N, now 0.03 and 0.04 N."""
    found: dict[str, float] = {
        "time_s": 10.0,
        "tick": 2000.0,
        "state": state,
        "state_bits": 4.0,
        "alarm": 0.0,
        "outcome": 0.0,
        "fresh": 1.0,
        "age_s": 0.004,
        "plc_heartbeat": 17.0,
        "status": 8.0,
        "unwind_tension_N": 88.0,
        "tension_ref_N": 90.0,
        "line_speed_m_s": 1.0,
        "unwind_radius_m": 0.2,
        "correction_unwind_m_s": 0.0,
        "applied_ratio_unwind_m_s": 1.0,
        "limit_ratio_unwind_m_s": 1.0,
    }
    for order, before in ((1, 3.0), (2, 4.0)):
        name = f"unwind.unwind_{order}x"
        found[f"{name}.shape_mm"] = 1.0
        found[f"{name}.state"] = float(OrderState.SETTLED)
        found[f"{name}.ripple_before"] = before
        found[f"{name}.ripple"] = 0.01 * before
    return found | more


def facts(**more: object) -> Facts:
    """Return what the door says beside the ring."""
    status = StatusAnswer(
        line="Euclid",
        state="STARTING",
        config_hash="3f9a" * 16,
        control_pid=7,
        recorder=RecorderReport(folder="/r", rows=1, alive=True),
        meetings=(MEETING,),
        facts=LINE,
    )
    named = {name: more.pop(name) for name in ("blocked", "also_blocking", "wire") if name in more}
    return Facts(status=replace(status, **more), **named)  # type: ignore[arg-type]


def seen(values: dict[str, float] | None = None, **more: object) -> Observed:
    """Return a moment in which all is well."""
    values = row() if values is None else values
    window = RecentWindow(tuple(values), tuple(values), LINE.cycle_s)
    window.add(np.tile(np.array(tuple(values.values())), (2000, 1)))
    moment = Observed(
        facts=facts(),
        facts_age_s=0.1,
        row=TickRow(values),
        tick_age_s=0.01,
        writer_lives=True,
        window=window,
    )
    return replace(moment, **more)  # type: ignore[arg-type]
