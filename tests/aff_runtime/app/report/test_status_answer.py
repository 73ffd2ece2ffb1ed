"""A status goes out as JSON and comes back as the same record."""

from __future__ import annotations

import json

import pytest

from aff_runtime.app.report.status import live_status
from aff_runtime.app.report.status_answer import (
    Alarm,
    Live,
    OperatorNote,
    StatusAnswer,
    read_answer,
)
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.signals import State
from aff_runtime.core.monitor import OrderState
from aff_runtime.telemetry.recorder_messages import RecorderReport
from tests.aff_runtime.app.report.test_status import SHAPE_SITE, record, shape_record

RECORDER = RecorderReport(folder="/r/x", rows=10, rows_lost=2, ring_overruns=1, alive=True)
LIVE = live_status(
    TickRow(record(State.FAULT, 0, 15) | shape_record("unwind_3x", OrderState.SETTLED)),
    ["LINE_RUN"],
    SHAPE_SITE,
)[1]


@pytest.mark.parametrize(
    "answer",
    [
        StatusAnswer(line="L", state="STARTING"),
        StatusAnswer(
            line="L",
            state="FAULT",
            config_hash="ab",
            site_hash="cd",
            learned=("x",),
            config_differs=("y",),
            control_pid=7,
            probing=True,
            recorder=RECORDER,
            shapes=("s",),
            meeting_sentences=("c",),
            operators=(OperatorNote(utc_s=1.8e9, did="arm", who="login anna"),),
            tick_age_s=0.004,
            live=LIVE,
        ),
    ],
)
def test_an_answer_comes_back_as_it_went_out(answer: StatusAnswer) -> None:
    assert read_answer(json.loads(json.dumps(answer.to_json()))) == answer


def test_before_the_first_record_nothing_live_is_said() -> None:
    said = StatusAnswer(line="L", state="STARTING").to_json()
    assert said["ok"] is True
    assert not {"signals", "blocks", "alarm", "comm", "blocked_by"} & set(said)
    assert read_answer(said).live is None


def test_what_a_newer_service_says_besides_is_left_out() -> None:
    said = StatusAnswer(line="L", state="ACTIVE", live=LIVE).to_json()
    said |= {"news": 1, "alarm": {"code": 3, "shade": "red"}}
    found = read_answer(said)
    assert found.live is not None
    assert found.live.alarm == Alarm(code=3)


def test_lost_rows_are_those_of_recorder_and_ring() -> None:
    assert RECORDER.lost == 3
    assert Live().alarm.code == 0
