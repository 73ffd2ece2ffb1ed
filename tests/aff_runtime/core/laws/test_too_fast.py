"""An order that turns too far between two readings to be learned is named before arming."""

from __future__ import annotations

from dataclasses import replace

import pytest

from aff_runtime.core.controller import Controller
from aff_runtime.core.laws.iterative import WIDEST_RAD
from aff_runtime.core.params import BlockParams
from tests.aff_runtime.core.plants import (
    ACTUATOR,
    CYCLE_S,
    FREE,
    LagDelay,
    Line,
    measured,
    site,
    snapshot,
)

GRID_HZ = [0.4 * 1.3**k for k in range(14)]
EVERY = 8  # ticks


def running(law, order, *, every=EVERY, seconds=30.0):
    """Return the controller after some time with a reading in every so many ticks."""
    plant = LagDelay(-400.0, delay=2, lag=0.5)
    blocks = (BlockParams(roll="unwind", orders=(order,), settle_s=8.0, amp_limit=0.02),)
    params = site(replace(ACTUATOR, law=law, blocks=blocks))
    controller = Controller(params, {"unwind": measured(plant.at, GRID_HZ)})
    line = Line(plant, {("unwind", order): 1.0 + 0j})
    for tick in range(round(seconds / CYCLE_S)):
        values = line.read()
        is_fresh = tick % every == 0 and tick % (900 * every) != 0  # and few are lost
        read = snapshot(line.tick, *values, fresh=is_fresh)
        (step,) = controller.step(read, CYCLE_S, FREE)
        line.advance(step.value)
    return controller


@pytest.mark.parametrize("order", [4, 6])
def test_what_is_named_is_what_does_not_learn(order):
    turned_rad = order * 5.0 * EVERY * CYCLE_S
    controller = running("iterative", order)
    (status,) = controller.order_statuses()
    too_fast = turned_rad > WIDEST_RAD
    assert too_fast is (order == 6)
    assert (status.size == 0.0) is too_fast
    said = controller.arming_objections()["unwind"]
    sentence = f"is too fast to be learned from a reading every {1e3 * EVERY * CYCLE_S:.0f} ms"
    assert [text.endswith(sentence) for text in said] == [True] * too_fast


def test_the_plain_law_learns_it_and_a_reading_per_tick_is_enough():
    assert running("blocks", 6).arming_objections() == {"unwind": ()}
    assert running("iterative", 6, every=1, seconds=2.0).arming_objections() == {"unwind": ()}
