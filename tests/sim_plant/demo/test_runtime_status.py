"""What the demo reads of the service's status."""

from aff_runtime.app.report.block_status import WORDS
from aff_runtime.core.monitor import Trend
from sim_plant.demo.runtime_status import HELD_PHASE, RuntimeStatus


def test_orders_that_rest_for_their_phase_are_named_and_no_others():
    said = {
        "state": "ACTIVE",
        "trying": "settings 0123 by somebody: 60 s left",
        "blocks": [
            {"actuator": "unwind", "name": "r9_1x", "state": HELD_PHASE},
            {"actuator": "unwind", "name": "unwind_1x", "state": "settled"},
        ],
    }
    status = RuntimeStatus.from_json(said)
    assert status.unsure == ("unwind.r9_1x",)
    assert status.trying


def test_the_word_is_the_services_own():
    assert WORDS[Trend.HELD_PHASE] == HELD_PHASE
