"""What reaches the guard, the record and the log from the law."""

from __future__ import annotations

import math
import random
import re
from dataclasses import replace
from types import SimpleNamespace

from aff_runtime.app.control.law_watch import STEADY_ASKS, HeldBlocks, LawWatch
from aff_runtime.app.wiring.law_slot import LawSlot
from aff_runtime.base.signals import State, Status
from aff_runtime.core.controller import Controller
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.order_status import OrderStatus, order_statuses
from aff_runtime.safety.guard import Guard
from aff_runtime.safety.params import ActuatorLimits, GuardParams, PermissiveParams
from tests.aff_runtime.core.plants import (
    ACTUATOR,
    CYCLE_S,
    LagDelay,
    Line,
    measured,
    site,
    snapshot,
)

OMEGA = 5.0
BEFORE_S = 12.0
LATCHES_WITHIN_S = 15.0 * math.tau / OMEGA
RUNS_ON_S = 1.2 * LATCHES_WITHIN_S
SIZE = {"blocks": "amplitude_m_s", "shape": "shape_mm"}


def orders(first: float, second: float, law: str = "blocks") -> tuple[OrderStatus, ...]:
    record = {"unwind.theta_rad": 0.3}
    for name, state in (("unwind_1x", first), ("unwind_2x", second)):
        record |= {f"unwind.{name}.{SIZE[law]}": 0.1, f"unwind.{name}.state": float(state)}
    return order_statuses(record)


def named(news: list[tuple[OrderStatus, OrderState]]) -> list[tuple[str, OrderState]]:
    return [(order.name, state) for order, state in news]


def test_a_held_block_is_told_once_and_by_its_name() -> None:
    held = HeldBlocks()
    told = [named(held.step(orders(OrderState.CLAMPED, OrderState.SETTLED))) for _ in range(100)]
    assert [news for news in told if news] == [[("unwind_1x", OrderState.CLAMPED)]]
    assert told[STEADY_ASKS - 1]


def test_flicker_is_not_told() -> None:
    held = HeldBlocks()
    for k in range(200):
        state = OrderState.CLAMPED if k % (STEADY_ASKS - 1) else OrderState.CONVERGING
        assert held.step(orders(state, OrderState.CONVERGING)) == []


def test_a_block_that_was_free_in_between_is_told_again() -> None:
    held = HeldBlocks()
    count = 0
    for state in (OrderState.HELD_PHASE, OrderState.SETTLED, OrderState.HELD_PHASE):
        for _ in range(2 * STEADY_ASKS):
            count += len(held.step(orders(OrderState.SETTLED, state)))
    assert count == 2


def test_nothing_is_told_while_no_output_is_open() -> None:
    held = HeldBlocks()
    for _ in range(5 * STEADY_ASKS):
        assert held.step(orders(OrderState.CLAMPED, math.nan), is_open=False) == []


class Loop:
    """Line, law, guard and watch in lockstep; the measured response is the true one times sign."""

    def __init__(self, sign: float) -> None:
        true = LagDelay(-300.0, delay=4, lag=0.9)
        noise = random.Random(1)
        ripple = {("unwind", 1): 2.0 + 0j, ("unwind", 2): 1.0j}
        self.line = Line(true, ripple, omega=OMEGA, seed_noise=lambda: noise.gauss(0.0, 0.3))
        response = measured(lambda f: sign * true.at(f), [0.3, 0.8, 1.6, 3.0])
        self.law = LawSlot(Controller(site(ACTUATOR), {"unwind": response}))
        self.guard = Guard(
            GuardParams(
                actuators=(ActuatorLimits(name="unwind", limit=0.05, slew_limit=2.0),),
                permissives=PermissiveParams(enable_from_plc=False),
            )
        )
        self.events: list[int] = []
        self.said: list[str] = []
        self.watch = LawWatch(self.events.append, self.said.append)
        signal = SimpleNamespace(signal="tension_N")
        self.site = SimpleNamespace(
            cycle_s=CYCLE_S, actuators={"unwind": SimpleNamespace(error=signal)}
        )

    def run(self, seconds: float) -> float:
        """Return the time after which the guard left ACTIVE, or all of it."""
        for k in range(round(seconds / CYCLE_S)):
            was_active = self.guard.state is State.ACTIVE
            tick = self.line.tick
            status = int(Status(0xFF) & ~(Status.REMOTE | Status.SPLICE_ACTIVE))
            read = replace(snapshot(tick, *self.line.read()), status=status)
            permission = self.guard.observe(read, tick * 5_000_000, False, True)
            steps = self.law.step(read, CYCLE_S, permission)
            (out,), _, _ = self.guard.limit(steps, CYCLE_S)
            self.line.advance(out)
            if tick % 20 == 0:
                state, quiet = self.guard.state, self.guard.quiet
                advice = self.watch.advise(
                    self.law, self.site, state=state, quiet=quiet, tick=tick
                )
                self.guard.ripple_rose = advice.ripple_rose
            if was_active and self.guard.state is not State.ACTIVE:
                return k * CYCLE_S
        return seconds

    def weight(self) -> float:
        return max(abs(w) for w in self.law.controller._laws[0].weights().values())


def test_a_wrong_sign_fades_latches_and_is_forgotten() -> None:
    loop = Loop(-1.0)
    loop.run(BEFORE_S)
    assert loop.guard.arm() == ""
    after_s = loop.run(30.0)
    assert loop.guard.state is State.FAULT
    assert after_s < LATCHES_WITHIN_S
    (said,) = (text for text in loop.said if "RIPPLE" in text)
    number = r"[\d.]+"
    assert re.fullmatch(
        f"RIPPLE_ROSE unwind: tension_N {number} N expected without correction, {number} N now",
        said,
    )
    assert loop.weight() > 0.0
    loop.run(1.0)
    assert loop.guard.quiet
    assert loop.weight() == 0.0


def test_after_an_arm_it_does_not_latch_again_at_once() -> None:
    loop = Loop(-1.0)
    loop.run(BEFORE_S)
    loop.guard.arm()
    first_s = loop.run(30.0)
    loop.run(0.5)  # the fade, and then the operator presses at once
    loop.guard.arm()
    loop.run(0.1)
    assert loop.guard.state is State.ACTIVE
    again_s = loop.run(30.0)
    assert again_s > 0.5 * first_s
    assert loop.guard.state is State.FAULT


def test_a_right_sign_runs_on() -> None:
    loop = Loop(1.0)
    loop.run(BEFORE_S)
    loop.guard.arm()
    assert loop.run(RUNS_ON_S) == RUNS_ON_S
    assert loop.guard.state is State.ACTIVE
    assert not loop.said
    assert not loop.events


def test_a_shape_that_rests_is_told_and_a_plain_block_that_rises_is_not() -> None:
    said: list[str] = []
    for kind in ("shape", "blocks"):
        watch = LawWatch(lambda code: None, said.append)
        rising = orders(OrderState.RISING, OrderState.SETTLED, kind)
        law = SimpleNamespace(order_statuses=lambda rising=rising: rising)
        for _ in range(3 * STEADY_ASKS):
            watch._note_blocks(law, is_open=True)  # type: ignore[arg-type]
    assert len(said) == 1
    assert "unwind.unwind_1x" in said[0]
    assert "does the drive take the correction?" in said[0]


def test_a_roll_whose_angle_has_another_origin_is_told_once() -> None:
    said: list[str] = []
    watch = LawWatch(lambda code: None, said.append)
    law = Controller(site(), {})
    slot = SimpleNamespace(probe=None, controller=law)
    line = Line(LagDelay(-400.0), {})
    params = SimpleNamespace(actuators={}, cycle_s=CYCLE_S)

    def advise() -> None:
        watch.advise(slot, params, state=State.READY, quiet=True, tick=line.tick)

    line.run(law, 1.0)
    advise()
    line.run(law, 1.0, fresh=False)
    line.theta += 1e4  # further than it can have turned
    for _ in range(5):
        line.run(law, 0.1)
        advise()
    assert [text.split(":")[0] for text in said] == ["unwind"]
    assert "what was learned on it is forgotten" in said[0]
