"""Whatever the PLC, the law and the operator do, in any order: the rules of the output hold."""

from __future__ import annotations

from math import inf, nan, pi

import pytest
from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from aff_runtime.base.signals import ActuatorStep, Outcome, State, StateBits, Status
from tests.aff_runtime.safety.bench import FADE_S, PARAMS, PERIOD_S, STEP, Bench

NUMBERS = st.one_of(
    st.floats(-0.2, 0.2), st.sampled_from([0.0, nan, inf, -inf, 1e300, -1e300, 1e-300, 0.05, 1e9])
)
STEPS = st.builds(ActuatorStep, value=NUMBERS, peak_bound=NUMBERS, slew_bound=NUMBERS)
REST = (State.FAULT, State.BYPASS)
CLOSED = (State.FAULT, State.BYPASS, State.OFF, State.SHADOW)
FADE_TICKS = round(FADE_S / PERIOD_S)


class OutputRules(RuleBasedStateMachine):
    @initialize(armed=st.booleans())
    def begin(self, armed: bool) -> None:
        self.bench = Bench()
        self.edge = False
        self.closed_ticks = 0
        self.broken: list[str] = []
        if armed:
            self.edge = True
            self.bench.active()
        self.before = self.bench.out
        self.state = self.bench.state

    def tick(self) -> None:
        bench = self.bench
        bench.run()
        for value, last, actuator in zip(bench.out, self.before, PARAMS.actuators, strict=True):
            self.check(abs(value) <= actuator.limit, f"|{value}| beyond the limit")
            rate = max(actuator.slew_limit, pi / 2 * actuator.limit / FADE_S)
            reach = rate * PERIOD_S * (1 + 1e-9)
            self.check(abs(value - last) <= reach, f"{last} to {value} faster than the slew limit")
        self.closed_ticks = self.closed_ticks + 1 if bench.state in CLOSED else 0
        if self.closed_ticks >= FADE_TICKS:
            self.check(bench.out == (0.0, 0.0), "not zero one fade time after closing")
        if any(bench.out):
            told = bench.bits & (StateBits.ACTIVE | StateBits.FADING)
            self.check(bool(told), "an output that the state word does not admit")
        if self.state in REST and bench.state not in REST:
            self.check(self.edge, "left rest without an edge")
            self.edge = False
        if bench.state in REST and self.state not in REST:
            self.edge = False
        self.before, self.state = bench.out, bench.state

    def check(self, holds: bool, text: str) -> None:
        if not holds:
            self.broken.append(text)

    @rule(ticks=st.integers(1, 40))
    def pass_time(self, ticks: int) -> None:
        for _ in range(ticks):
            self.tick()

    @rule(step=STEPS, other=STEPS, ticks=st.integers(1, 8))
    def wish(self, step: ActuatorStep, other: ActuatorStep, ticks: int) -> None:
        self.bench.steps = (step, other)
        self.pass_time(ticks)

    @rule()
    def behave(self) -> None:
        self.bench.steps = (STEP, STEP)
        self.tick()

    @rule(steps=st.sampled_from([None, (), (STEP,), (STEP, STEP, STEP)]))
    def law_fails(self, steps: tuple[ActuatorStep, ...] | None) -> None:
        self.bench.steps = steps
        self.tick()

    @rule()
    def arm(self) -> None:
        self.bench.guard.arm()
        self.edge = True
        self.tick()

    @rule()
    def heal_and_arm(self) -> None:
        bench = self.bench
        bench.outcome, bench.overrun, bench.supervisor_alive = Outcome.OK, False, True
        bench.tension_N, bench.speed_m_s, bench.radius_m = 90.0, 1.0, 0.2
        bench.heartbeat_moves, bench.status = True, bench.status | 0b111001 | 2
        bench.status &= ~(Status.SPLICE_ACTIVE | Status.REMOTE)
        bench.steps = (STEP, STEP)
        bench.guard.shadow(False)
        self.pass_time(FADE_TICKS + 2)
        bench.guard.arm()
        self.edge = True
        self.pass_time(50)

    @rule()
    def bypass(self) -> None:
        self.bench.guard.bypass()
        self.edge = False
        self.tick()
        self.check(self.bench.state is State.BYPASS, "bypass did not act in one tick")

    @rule(on=st.booleans())
    def shadow(self, on: bool) -> None:
        self.bench.guard.shadow(on)
        self.edge = self.edge or on
        self.tick()

    @rule(bit=st.sampled_from(list(Status)), on=st.booleans())
    def status(self, bit: Status, on: bool) -> None:
        (self.bench.set if on else self.bench.clear)(bit)
        if bit is Status.RESET_EDGE and on and self.bench.status & Status.REMOTE:
            self.edge = True
        self.tick()

    @rule(value=NUMBERS, name=st.sampled_from(["tension_N", "speed_m_s", "radius_m"]))
    def reading(self, value: float, name: str) -> None:
        setattr(self.bench, name, value)
        self.tick()

    @rule(outcome=st.sampled_from(list(Outcome)), ticks=st.integers(1, 30))
    def wire(self, outcome: Outcome, ticks: int) -> None:
        self.bench.outcome = outcome
        self.pass_time(ticks)

    @rule(moves=st.booleans())
    def heartbeat(self, moves: bool) -> None:
        self.bench.heartbeat_moves = moves
        self.tick()

    @rule(overrun=st.booleans(), alive=st.booleans())
    def process(self, overrun: bool, alive: bool) -> None:
        self.bench.overrun, self.bench.supervisor_alive = overrun, alive
        self.tick()

    @rule()
    def something_raised(self) -> None:
        self.bench.guard.internal_fault()
        self.tick()

    @rule()
    def new_roll(self) -> None:
        self.bench.roll_id += 1
        self.tick()

    @invariant()
    def every_rule_held_in_every_tick(self) -> None:
        assert not self.broken, self.broken


class OutputRulesForLong(OutputRules):
    """The same rules, looked at for twenty times as long."""


HOW = settings(
    max_examples=30,
    stateful_step_count=30,
    phases=[Phase.explicit, Phase.reuse, Phase.generate, Phase.shrink],
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
OutputRules.TestCase.settings = HOW
OutputRulesForLong.TestCase.settings = settings(HOW, max_examples=600)
TestOutputRules = OutputRules.TestCase
TestOutputRulesForLong = pytest.mark.long(OutputRulesForLong.TestCase)
