"""With a PLC slower than the cycle, an order that learns says so in the ticks between readings."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from aff_runtime.core.controller import Controller
from aff_runtime.core.monitor import OrderState
from tests.aff_runtime.core.plants import (
    ACTUATOR,
    CYCLE_S,
    FREE,
    FROZEN,
    GRID_HZ,
    LagDelay,
    Line,
    measured,
    site,
    snapshot,
)
from tests.aff_runtime.core.shape_site import DRIVE

LAW_WORDS = ["blocks", "iterative", "shape"]
EVERY = 4  # ticks from reading to reading


class SlowPlc:
    """A law in a cycle four times as fast as its PLC."""

    def __init__(self, law):
        plant = LagDelay(-400.0, delay=12, lag=0.96)
        params = site(replace(ACTUATOR, law=law, drive=DRIVE))
        self.law = Controller(params, {"unwind": measured(plant.at, GRID_HZ)})
        self.line = Line(plant, {("unwind", 1): 2.0 + 1.0j, ("unwind", 2): 0.5j})

    def states(self, ticks, permission=FREE, *, signal=None):
        """Return the states of both orders after each tick; the first one has a reading."""
        seen = []
        for tick in range(ticks):
            values = list(self.line.read())
            if signal is not None:
                values[0] = signal
            read = snapshot(self.line.tick, *values, fresh=tick % EVERY == 0)
            (step,) = self.law.step(read, CYCLE_S, permission)
            seen.append({order.state for order in self.law.order_statuses()})
            self.line.advance(step.value)
        return seen


@pytest.mark.parametrize("law", LAW_WORDS)
def test_an_order_that_learns_is_frozen_in_no_tick(law):
    plc = SlowPlc(law)
    plc.states(400)  # the gate opens, two turns are seen
    assert not any(OrderState.FROZEN in states for states in plc.states(40 * EVERY))


@pytest.mark.parametrize("law", LAW_WORDS)
def test_without_permission_it_is_frozen_at_once_and_until_the_next_reading(law):
    plc = SlowPlc(law)
    plc.states(401)
    assert set(map(frozenset, plc.states(2, FROZEN))) == {frozenset({OrderState.FROZEN})}
    plc = SlowPlc(law)
    plc.states(400)
    plc.states(EVERY, FROZEN)
    assert all(OrderState.FROZEN not in states for states in plc.states(EVERY))


@pytest.mark.parametrize("law", LAW_WORDS)
def test_a_reading_that_is_no_number_freezes_it_until_the_next_one(law):
    plc = SlowPlc(law)
    plc.states(400)
    assert set(map(frozenset, plc.states(EVERY, signal=math.nan))) == {
        frozenset({OrderState.FROZEN})
    }
    assert all(OrderState.FROZEN not in states for states in plc.states(EVERY))
