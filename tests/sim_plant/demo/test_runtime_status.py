"""What the demo reads of the service's status."""

from aff_runtime.app.report.block_status import WORDS
from aff_runtime.app.report.status_answer import Alarm, Live, StatusAnswer
from aff_runtime.core.monitor import OrderState
from sim_plant.demo.runtime_status import CLAMPED, HELD_PHASE, RuntimeStatus


def test_orders_that_rest_for_their_phase_and_that_give_way_are_named():
    said = {
        "state": "ACTIVE",
        "trying": "settings 0123 by somebody: 60 s left",
        "blocks": [
            {"actuator": "unwind", "name": "r9_1x", "state": HELD_PHASE},
            {"actuator": "unwind", "name": "unwind_1x", "state": "settled"},
            {"actuator": "unwind", "name": "unwind_8x", "state": CLAMPED},
        ],
    }
    status = RuntimeStatus.from_json(said)
    assert status.unsure == ("unwind.r9_1x",)
    assert status.giving_way == ("unwind.unwind_8x",)
    assert status.trying


def test_the_words_are_the_services_own():
    assert WORDS[OrderState.HELD_PHASE] == HELD_PHASE
    assert WORDS[OrderState.CLAMPED] == CLAMPED


def test_the_keys_are_those_of_the_services_own_answer():
    alarm = Alarm(code=1, name="PLC_STALE", text="PLC data is stale")
    live = Live(alarm=alarm, blocked_by="REMOTE=1", signals={"missed_count": 3.0})
    answer = StatusAnswer(line="l", state="READY", trying="settings 0123", live=live)
    status = RuntimeStatus.from_json(answer.to_json())
    assert (status.state, status.trying, status.missed_ticks) == ("READY", "settings 0123", 3)
    assert (status.blocked_by, status.alarm) == ("REMOTE=1", "PLC data is stale")
