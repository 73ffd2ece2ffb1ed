"""A roll whose angle is lost sends nothing under the laws in blocks, and comes back softly."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from aff_runtime.core.controller import Controller
from aff_runtime.core.gate import ANGLE_FADE_S, AngleGate
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.params import BlockParams
from aff_runtime.core.phase import PREDICT_MAX_S
from tests.aff_runtime.core.plants import (
    ACTUATOR,
    CYCLE_S,
    FREE,
    GRID_HZ,
    RIPPLE,
    SWRAP,
    UNWIND,
    LagDelay,
    Line,
    measured,
    rms,
    site,
    snapshot,
)

ANGLE = 3  # of the line's readings
ROUNDING = 2e-5


class LosesAngle(Line):
    """The unwind's encoder reads nothing while ``lost``."""

    lost = False

    def read(self):
        values = list(super().read())
        if self.lost:
            values[ANGLE] = math.nan
        return tuple(values)


def line_and_law(law, **more):
    plant = LagDelay(-400.0, delay=12, lag=0.96)
    params = site(replace(ACTUATOR, law=law, **more))
    params = replace(params, rolls=(replace(UNWIND, line_speed=None), SWRAP))
    return LosesAngle(plant, RIPPLE), Controller(params, {"unwind": measured(plant.at, GRID_HZ)})


# what a lost angle does to blocks is the bank's, however they adapt
@pytest.mark.parametrize("law", ["blocks", pytest.param("iterative", marks=pytest.mark.long)])
def test_without_an_angle_ripple_is_no_larger_than_without_correction(law):
    line, controller = line_and_law(law)
    line.run(controller, 30.0)
    line.lost, line.omega = True, 4.5
    line.run(controller, PREDICT_MAX_S + ANGLE_FADE_S + 4 * CYCLE_S)
    alone = math.sqrt(sum(abs(c) ** 2 for c in RIPPLE.values()) / 2.0)
    for _ in range(6):
        assert rms(line.run(controller, math.tau / 4.5)) < 1.05 * alone
    (step,) = controller.step(snapshot(line.tick, *line.read()), CYCLE_S, FREE)
    assert step.value == step.peak_bound == 0.0


def test_the_slew_bound_covers_the_fade_and_the_way_back():
    line, controller = line_and_law("blocks")
    line.run(controller, 25.0)
    last, values = None, []
    for k in range(1000):
        line.lost = k < 400
        (step,) = controller.step(snapshot(line.tick, *line.read()), CYCLE_S, FREE)
        if last is not None:
            assert abs(step.value - last) <= step.slew_bound * CYCLE_S + ROUNDING
        last = step.value
        values.append(step.value)
        line.advance(step.value)
    fading = slice(round((PREDICT_MAX_S + ANGLE_FADE_S) / CYCLE_S) + 2, 400)
    assert max(abs(value) for value in values[fading]) == 0.0
    assert max(abs(value) for value in values[600:]) > 0.0


def test_a_roll_without_an_angle_leaves_the_others_alone():
    blocks = tuple(
        BlockParams(roll=roll, orders=(1,), settle_s=6.0, amp_limit=0.02)
        for roll in ("unwind", "swrap")
    )
    line, controller = line_and_law("blocks", blocks=blocks)
    line.ripple = {("unwind", 1): 2.0 + 0j, ("swrap", 1): 1.0 + 0j}
    line.run(controller, 25.0)
    line.lost = True
    line.run(controller, 2.0)
    (step,) = controller.step(snapshot(line.tick, *line.read()), CYCLE_S, FREE)
    orders = {order.name: order for order in controller.order_statuses()}
    assert step.peak_bound == pytest.approx(orders["swrap_1x"].size)
    assert orders["unwind_1x"].size > 0.0
    assert orders["unwind_1x"].state is OrderState.FROZEN


@pytest.mark.parametrize("law", ["blocks", "iterative"])
def test_a_lost_roll_stands_against_arming(law):
    line, controller = line_and_law(law)
    line.run(controller, 2.0)
    assert controller.arming_objections() == {"unwind": ()}
    line.lost = True
    line.run(controller, PREDICT_MAX_S + 2 * CYCLE_S)
    assert controller.arming_objections() == {"unwind": ("unwind: its angle is lost",)}


def test_retuning_while_an_angle_is_lost_sends_nothing_either():
    line, controller = line_and_law("blocks")
    line.run(controller, 20.0)
    line.lost = True
    line.run(controller, 2.0)
    _, successor = line_and_law("blocks")
    successor.adopt(controller)
    assert any(abs(order.size) > 0.0 for order in successor.order_statuses())
    (step,) = successor.step(snapshot(line.tick, *line.read()), CYCLE_S, FREE)
    assert step.value == step.peak_bound == 0.0


def test_the_share_moves_only_where_something_was_learned():
    gate = AngleGate()
    gate.step(True, False, CYCLE_S)
    assert gate.share == 1.0
    shares = []
    for _ in range(round(ANGLE_FADE_S / CYCLE_S) + 1):
        gate.step(False, True, CYCLE_S)
        shares.append(gate.share)
    wanted = [max(0.0, 1.0 - (k + 1) * CYCLE_S / ANGLE_FADE_S) for k in range(len(shares))]
    assert shares == pytest.approx(wanted, abs=1e-9)
    gate.step(True, False, CYCLE_S)
    assert gate.share == 1.0
