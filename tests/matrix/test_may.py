"""``may`` against the service: guard state x fault x action, what it says is what is answered.

The control process's own outside answers in lockstep; nothing is real time.
"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import pytest

from aff_runtime.app.control.outside import ControlOutside
from aff_runtime.app.hand.may import WORDS, Action, Circumstances, Code, Person, Place, Role, may
from aff_runtime.app.link import messages, replies
from aff_runtime.app.link.packets import Link, link_pair
from aff_runtime.app.wiring.assemble import controller_of
from aff_runtime.app.wiring.law_slot import LawSlot
from aff_runtime.base.events import BY_CODE, Reaction
from aff_runtime.base.signals import LATCHED_STATES, State, Status
from aff_runtime.loop.cycle import Cycle
from aff_runtime.telemetry.header import RunMeta
from tests.matrix.bench import SITES, MatrixBench
from tests.matrix.cells import TABLE
from tests.parameter_records import record_of

OWN = Person(role=Role.OPERATE, place=Place.PANEL, has_hand=True)
CARL = replace(OWN, role=Role.COMMISSION)
ANSWERED_TICKS = 130
PROBED_TICKS = 230  # a probe that cannot begin is told after a second
SHOWN_S = 0.15
NEVER_NS = 1 << 62  # a question that is never too late


@cache
def slot() -> LawSlot:
    return LawSlot(controller_of(SITES["modbus"], {}, {}))


class ServiceBench(MatrixBench):
    """The matrix's bench, with the control process's own outside and a link to it."""

    def __init__(self) -> None:
        self.blocked, self.others = "", tuple[str, ...]()
        self.asked, self.replies = 0, dict[int, replies.Reply]()
        self.probed: messages.Probed | None = None
        super().__init__("modbus")
        kept = self.cycle
        ours, theirs = link_pair()
        self.link, self.outside_link = Link(ours), Link(theirs)
        assembly = SimpleNamespace(
            site=self.site,
            guard=self.guard,
            gateway=kept._gateway,
            law=slot(),
            parameters=record_of(self.site),
        )
        self.outside = ControlOutside(assembly, self.outside_link, RunMeta())  # type: ignore[arg-type]
        self.cycle = Cycle(
            settings=kept._settings,
            clock=self.clock,
            gateway=kept._gateway,
            guard=self.guard,
            law=self.law,
            outside=self.outside,
        )
        self.cycle._ticker.start()

    def step(self) -> float:
        found = super().step()
        self.hear()
        return found

    def hear(self) -> None:
        while (message := self.link.receive()) is not None:
            if isinstance(message, messages.Blocked):
                self.blocked, self.others = message.text, message.others
            elif isinstance(message, replies.Reply):
                self.replies[message.id] = message
            elif isinstance(message, messages.Probed):
                self.probed = message

    def arm(self) -> None:
        self.ask()

    def ask(self) -> int:
        self.asked += 1
        self.link.send(messages.Arm(id=self.asked, valid_until_ns=NEVER_NS))
        return self.asked

    def bypass(self) -> None:
        self.link.send(messages.Bypass())

    def begin(self, spec: str) -> None:
        if spec == "remote":
            self.plant.plc.set_status(Status.REMOTE, True)
        elif spec:
            super().begin(spec)

    def reply(self) -> replies.Reply:
        ident = self.ask()
        for _ in range(ANSWERED_TICKS):
            self.run(self.sample_s)
            if ident in self.replies:
                return self.replies[ident]
        raise AssertionError("no answer")

    def probe_error(self) -> str:
        """Ask for a probe; return why it came to nothing, empty while it is under way."""
        self.asked += 1
        self.link.send(messages.MeasureResponse(id=self.asked, valid_until_ns=NEVER_NS))
        for _ in range(PROBED_TICKS):
            self.run(self.sample_s)
            answer = self.replies.get(self.asked)
            if answer is not None and not answer.ok:
                return answer.message
            if self.probed is not None:
                return self.probed.error
        return ""

    def close(self) -> None:
        self.outside.close()
        self.link.close()
        self.outside_link.close()


@pytest.fixture
def bench() -> Iterator[ServiceBench]:
    with contextlib.closing(ServiceBench()) as found:
        yield found


def _powered(bench: ServiceBench) -> None:
    bench.run(0.3)


def _bypassed(bench: ServiceBench) -> None:
    bench.run(0.3)
    bench.bypass()
    bench.run(0.1)


def _shadowed(bench: ServiceBench) -> None:
    bench.run(0.3)
    bench.link.send(messages.Shadow(id=99, valid_until_ns=NEVER_NS, on=True))
    bench.run(0.1)


def _ready(bench: ServiceBench) -> None:
    _shadowed(bench)
    bench.link.send(messages.Shadow(id=99, valid_until_ns=NEVER_NS, on=False))
    bench.run(0.1)


def _off(bench: ServiceBench) -> None:
    _ready(bench)
    bench.plant.plc.set_status(Status.WEB_INTACT, False)
    bench.run(0.1)


def _active(bench: ServiceBench) -> None:
    bench.run(0.3)
    bench.arm()
    assert bench.until(State.ACTIVE, within_s=1.0)
    bench.run(0.3)


def _armed(bench: ServiceBench) -> None:
    outputs = tuple(replace(a, active_above_m_s=50.0) for a in bench.guard.params.actuators)
    bench.guard.adopt(replace(bench.guard.params, actuators=outputs))
    bench.run(0.3)
    bench.arm()
    bench.run(0.1)


def _fading(bench: ServiceBench) -> None:
    _active(bench)
    bench.plant.plc.set_status(Status.LINE_RUN, False)
    bench.run(0.05)


WAYS: dict[State, Callable[[ServiceBench], None]] = {
    State.FAULT: _powered,
    State.BYPASS: _bypassed,
    State.SHADOW: _shadowed,
    State.READY: _ready,
    State.OFF: _off,
    State.ARMED: _armed,
    State.ACTIVE: _active,
    State.FADING: _fading,
}
# of the runtime's own death nobody is left to answer
FAULTS = {
    row["name"]: row["spec"]
    for row in TABLE["faults"]
    if row["modbus"] != "-" and not row["spec"].startswith(("!kill", "!supervisor", "!stall"))
}
WHATEVER = {"none": "", "remote": "remote", **FAULTS}
CELLS = [(state, name, spec) for state in WAYS for name, spec in WHATEVER.items()]


def shows(bench: ServiceBench, spec: str) -> None:
    """Let a fault show and be told, unless a fade is over by then."""
    bench.begin(spec)
    bench.run(0.02 if bench.guard.state is State.FADING else SHOWN_S)
    if bench.guard.state is not State.FADING:
        bench.run(SHOWN_S)


def lasting(spec: str) -> str:
    """Return a fault that is still there when a probe gives up."""
    return re.sub(r":1$", ":3", spec)


def test_two_who_arm_while_the_guard_decides_are_both_answered(bench: ServiceBench) -> None:
    WAYS[State.OFF](bench)
    first = bench.ask()
    bench.run(2 * bench.sample_s)
    assert first not in bench.replies
    second = bench.ask()
    bench.run(ANSWERED_TICKS * bench.sample_s)
    assert [bench.replies[one].state for one in (first, second)] == ["OFF", "OFF"]


def test_there_is_a_way_into_every_state() -> None:
    assert set(WAYS) == set(State)


# a probe takes the place of a law that fails, and would work; no screen begins one beside that
OF_THE_LAW = ("!law", "!lazy", "!nan")
# a sweep below comes by every state, each by other faults
EVERY_CELL = pytest.mark.parametrize(
    ("state", "fault", "spec"), CELLS, ids=lambda one: getattr(one, "name", one)
)


@EVERY_CELL
@pytest.mark.sweep(every=19)
def test_what_may_says_of_arm_is_what_the_service_answers(
    bench: ServiceBench, state: State, fault: str, spec: str
) -> None:
    WAYS[state](bench)
    assert bench.guard.state is state
    shows(bench, spec)
    before = bench.guard.state
    now = Circumstances(
        state=before, blocked=bench.blocked, also_blocking=bench.others, ceiling=Role.OPERATE
    )
    reasons = may(Action.ARM, OWN, now)
    answer = bench.reply()
    if not reasons:
        assert answer.ok, (before, answer.message)
    elif reasons[0].code is Code.ALREADY:
        assert answer.ok
        assert before in (State.ARMED, State.ACTIVE)
    else:
        assert not answer.ok, (before, reasons[0].text)
        if reasons[0].code is Code.GUARD:
            assert answer.message.endswith(reasons[0].text)


@EVERY_CELL
@pytest.mark.sweep(every=23)
def test_what_may_says_of_probe_is_what_comes_of_it(
    bench: ServiceBench, state: State, fault: str, spec: str
) -> None:
    WAYS[state](bench)
    shows(bench, lasting(spec))
    before = bench.guard.state
    now = Circumstances(
        state=before, blocked=bench.blocked, also_blocking=bench.others, ceiling=Role.COMMISSION
    )
    reasons = may(Action.PROBE, CARL, now)
    error = bench.probe_error()
    if not reasons:
        assert error == "", (before, bench.blocked)
        assert bench.guard.state in (State.ARMED, State.ACTIVE)
    elif before is State.SHADOW:  # said at once, whatever else there is
        assert error.endswith("SHADOW=1")
    elif reasons[0].code is Code.GUARD and not spec.startswith(OF_THE_LAW):
        waits = bench.guard.state is State.READY  # for ten seconds, and nothing goes out
        assert waits or error.endswith(reasons[0].name), (before, reasons[0].text)


@EVERY_CELL
@pytest.mark.sweep(every=25)
def test_bypass_is_never_refused_and_always_done(
    bench: ServiceBench, state: State, fault: str, spec: str
) -> None:
    WAYS[state](bench)
    shows(bench, spec)
    now = Circumstances(state=bench.guard.state, blocked=bench.blocked, also_blocking=bench.others)
    assert may(Action.BYPASS, Person(role=Role.VIEW, place=Place.NETWORK), now) == ()
    bench.bypass()
    bench.run(0.05)
    assert bench.guard.state is State.BYPASS


@EVERY_CELL
@pytest.mark.sweep(every=26)
def test_what_may_says_of_shadow_is_what_comes_of_it(
    bench: ServiceBench, state: State, fault: str, spec: str
) -> None:
    WAYS[state](bench)
    shows(bench, lasting(spec))
    before = bench.guard.state
    now = Circumstances(
        state=before, blocked=bench.blocked, also_blocking=bench.others, ceiling=Role.OPERATE
    )
    reasons = may(Action.SHADOW, OWN, now)
    bench.link.send(messages.Shadow(id=99, valid_until_ns=NEVER_NS, on=True))
    bench.run(0.1)
    if not reasons or reasons[0].code is Code.SHADOWED:
        assert bench.guard.state in (State.SHADOW, State.FAULT), (before, bench.blocked)
        if bench.guard.state is State.FAULT:  # only what latches meanwhile leads there
            assert before not in LATCHED_STATES, (before, bench.blocked)
            latched = BY_CODE[bench.alarm]
            assert latched.reaction is Reaction.FADE_AND_LATCH, latched.name
            assert latched.name != "POWER_UP"  # what FAULT says that nothing has led to
    else:
        assert bench.guard.state is before, (before, reasons[0].text)
    bench.link.send(messages.Shadow(id=99, valid_until_ns=NEVER_NS, on=False))
    bench.run(0.1)
    assert bench.guard.state is not State.SHADOW
    assert bench.guard.state not in (State.ARMED, State.ACTIVE)


@EVERY_CELL
@pytest.mark.sweep(every=29)
def test_what_may_says_of_forgetting_is_what_the_service_answers(
    bench: ServiceBench, state: State, fault: str, spec: str
) -> None:
    WAYS[state](bench)
    shows(bench, lasting(spec))
    before, is_quiet = bench.guard.state, bench.guard.quiet
    now = Circumstances(
        state=before, blocked=bench.blocked, also_blocking=bench.others, ceiling=Role.OPERATE
    )
    reasons = may(Action.FORGET, OWN, now)
    bench.asked += 1
    bench.link.send(messages.Forget(id=bench.asked, valid_until_ns=NEVER_NS))
    bench.run(0.02)
    answer = bench.replies[bench.asked]
    if reasons:
        assert before in (State.ACTIVE, State.FADING)
        assert answer.ok or answer.message == reasons[0].text
    elif is_quiet:
        assert answer.ok
    else:  # of a fade that is not over, only the service knows
        assert answer.ok or answer.message == WORDS[Code.GOES_OUT]
