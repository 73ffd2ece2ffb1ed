"""Answers of the control socket: one layout as JSON, and back as the same record."""

from __future__ import annotations

import json

from sim_plant.servers.answers import Answer, Done, History, PlantStatus, Refused, to_json
from tests.each_case import each_case

STATUS = {
    "time_s": 1.5,
    "applied_m_s": {"unwind": 0.001},
    "max_abs_applied_m_s": {"unwind": 0.02},
    "counts_now": True,
    "refusal": "",
    "true_tension_N": {"true_unwind_tension_N": 88.9},
    "measured": {"unwind_tension_N": None},
    "status": ["LINE_RUN", "REMOTE"],
    "roll_id": 2,
    "web": {"left_m": None, "state": "runs", "say": ""},
    "aff": {"state": 5, "echo": 7, "state_bits": ["ARMED"]},
    "faults": ["mute"],
    "counts": {
        "scans": 1,
        "late_samples": 90,
        "skipped_samples": 7,
        "watchdog_trips": 2,
        "reads": 3,
        "writes": 4,
        "foreign_reads": 5,
        "foreign_writes": 6,
        "frames_sent": 8,
        "frames_taken": 9,
    },
    "realtime": "granted",
}


def test_a_status_comes_back_as_it_went_out() -> None:
    found = PlantStatus.from_json(STATUS)
    assert json.dumps(to_json(found)) == json.dumps(STATUS)
    assert found.counts.wire == {"frames_sent": 8, "frames_taken": 9}
    assert found.aff_bits == ["ARMED"]


@each_case(
    ("answer", "said"),
    [
        (Done(), '{"ok": true}'),
        (Done(start_s=2.5), '{"ok": true, "start_s": 2.5}'),
        (Done(change_s=0.0), '{"ok": true, "change_s": 0.0}'),
        (Refused(error="no"), '{"error": "no"}'),
        (
            History(actuators=["unwind"], time_s=[0.5], applied_m_s=[(0.001,)]),
            '{"actuators": ["unwind"], "time_s": [0.5], "applied_m_s": [[0.001]]}',
        ),
    ],
)
def test_an_answer_says_what_there_is_to_say(answer: Answer, said: str) -> None:
    assert json.dumps(to_json(answer)) == said
