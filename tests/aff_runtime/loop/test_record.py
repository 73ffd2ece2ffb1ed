from __future__ import annotations

from dataclasses import replace
from math import isnan

import pytest

from aff_runtime.base.signals import NO_ECHO, Outcome, Permission, Snapshot, State
from aff_runtime.loop.record import TickTiming, build_record, record_columns

SNAPSHOT = Snapshot(
    tick=4,
    t_ns=0,
    outcome=Outcome.OK,
    fresh=True,
    age_s=0.001,
    plc_heartbeat=12,
    status=63,
    roll_id=2,
    values=(90.0, 1.5),
    echo_age=2,
    applied=(0.004,),
)
TIMING = TickTiming(
    tick=4, time_s=0.02, periods=1, wake_ns=1500, io_ns=200_000, tick_ns=300_000, missed=3
)


def row(law_values: tuple[float, ...], snapshot: Snapshot = SNAPSHOT) -> dict[str, float]:
    names = record_columns(("tension_N", "speed_m_s"), ("unwind_m_s",), ("a", "b"))
    values = build_record(
        snapshot=snapshot,
        state=State.ACTIVE,
        state_bits=5,
        alarm=0,
        wanted=(0.01,),
        corrections=(0.005,),
        permission=Permission(adapt=True, applied_ratio=(0.5,), limit_ratio=(0.9,)),
        timing=TIMING,
        law_values=law_values,
        law_columns=2,
    )
    return dict(zip(names, values, strict=True))


def test_every_number_stands_under_its_name() -> None:
    record = row((7.0, 8.0))
    expected = {
        "time_s": 0.02,
        "tick": 4,
        "state": 4,
        "plc_heartbeat": 12,
        "roll_id": 2,
        "tension_N": 90.0,
        "speed_m_s": 1.5,
        "wanted_unwind_m_s": 0.01,
        "correction_unwind_m_s": 0.005,
        "plc_applied_unwind_m_s": 0.004,
        "echo_age": 2,
        "applied_ratio_unwind_m_s": 0.5,
        "limit_ratio_unwind_m_s": 0.9,
        "wake_us": 1.5,
        "io_us": 200.0,
        "tick_us": 300.0,
        "missed_count": 3,
        "a": 7.0,
        "b": 8.0,
    }
    assert {name: record[name] for name in expected} == pytest.approx(expected)


def test_the_row_keeps_its_width_when_another_law_tells_more_or_less() -> None:
    assert row((7.0, 8.0, 9.0))["b"] == 8.0
    assert isnan(row((7.0,))["b"])


def test_what_no_plc_word_shows_is_no_number() -> None:
    record = row((), replace(SNAPSHOT, applied=(), echo_age=NO_ECHO))
    assert isnan(record["plc_applied_unwind_m_s"])
    assert record["echo_age"] == -1
    assert record["applied_ratio_unwind_m_s"] == 0.5  # what stands behind it stays in its place
