"""What was asked of the control process is done in its time, or not at all."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

import pytest

from aff_runtime.app.control.outside import ARM_PATIENCE_TICKS, TOO_LATE, ControlOutside
from aff_runtime.app.link.answers import Done, as_answer
from aff_runtime.app.link.messages import (
    Arm,
    Bypass,
    Forget,
    LogLine,
    MeasureResponse,
    Parameters,
    Question,
    Shadow,
)
from aff_runtime.app.link.packets import Link, link_pair
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.report.status import refused_arm
from aff_runtime.app.supervisor.pending import PATIENCE_S, REPLY_NS, Pending
from aff_runtime.app.wiring.assemble import controller_of
from aff_runtime.app.wiring.law_slot import LawSlot
from aff_runtime.base.signals import State
from aff_runtime.loop import messages as loop
from aff_runtime.loop.record import record_columns
from aff_runtime.telemetry.header import RunMeta
from tests.doubles.virtual_clock import VirtualClock
from tests.parameter_records import EUCLID, record_of

QUESTIONS: dict[str, tuple[Question, set[type]]] = {
    "arm": (Arm(), {loop.Arm}),
    "shadow": (Shadow(), {loop.Shadow}),
    "probe": (MeasureResponse(actuators=("unwind",)), {loop.Swap, loop.Arm}),
    "parameters": (Parameters(record=record_of()), {loop.Swap}),
    "forget": (Forget(), set()),
}


class Ends:
    """Both ends of a link, and the time that they have in common."""

    def __init__(self) -> None:
        self.clock = VirtualClock(10**12)
        ours, theirs = link_pair()
        self.link, self._other = Link(ours), Link(theirs)
        self.pending = Pending(self.clock)
        self.told: list[Reply] = []
        self.guard = SimpleNamespace(
            state=State.READY, quiet=True, first_blocking=lambda: "", has_connected=True
        )
        assembly = SimpleNamespace(
            site=EUCLID,
            guard=self.guard,
            gateway=SimpleNamespace(troubles=()),
            law=LawSlot(controller_of(EUCLID, {}, {})),
            parameters=record_of(),
        )
        self.outside = ControlOutside(assembly, self._other, RunMeta(), self.clock)  # type: ignore[arg-type]

    def ask(self, question: Question) -> None:
        def answer(reply: Reply) -> Done:
            self.told.append(reply)
            return as_answer(reply)

        self.pending.ask(SimpleNamespace(link=self.link), question, answer)  # type: ignore[arg-type]

    def done(self) -> set[type]:
        """Have the control process look, after a stall; return what it has the cycle do."""
        return {type(one) for one in self.outside.poll()}

    def tick(self, tick: int) -> None:
        columns = record_columns(tuple(EUCLID.gateway.read.channels), tuple(EUCLID.actuators), ())
        self.outside.publish([0.0, float(tick), *[0.0] * (len(columns) - 2)])

    def heard(self) -> list[object]:
        found: list[object] = []
        while (said := self.link.receive()) is not None:
            found.append(said)
        return found

    def close(self) -> None:
        self.outside.close()
        self.link.close()
        self._other.close()


@pytest.fixture
def ends() -> Iterator[Ends]:
    found = Ends()
    yield found
    found.close()


@pytest.mark.parametrize(("question", "does"), QUESTIONS.values(), ids=QUESTIONS)
def test_a_question_is_obeyed_until_its_time_is_over_and_not_after(
    ends: Ends, question: Question, does: set[type]
) -> None:
    stall_ns = int(PATIENCE_S * 1e9) - REPLY_NS + 1
    ends.ask(question)
    ends.clock.advance_ns(stall_ns)
    assert ends.done() == set()
    replies = [said for said in ends.heard() if isinstance(said, Reply)]
    assert [(one.ok, one.message) for one in replies] == [(False, TOO_LATE)]
    ends.ask(question)
    ends.clock.advance_ns(stall_ns - 1)
    assert ends.done() == does
    assert not any(isinstance(said, LogLine) for said in ends.heard())


def test_who_was_told_that_nobody_replied_does_not_find_it_done_later(ends: Ends) -> None:
    """The control process stalls; whoever asked gives up; then it goes on."""
    ends.ask(Arm())
    ends.clock.advance_ns(int(PATIENCE_S * 1e9))
    ends.pending.expire()
    assert [one.message for one in ends.told] == ["the control process did not reply in time"]
    assert ends.done() == set()
    said = ends.heard()
    assert LogLine(text=f"Arm {TOO_LATE}") in said
    for one in said:
        if isinstance(one, Reply):
            ends.pending.resolve(one)
    assert len(ends.told) == 1


def test_a_bypass_is_never_too_late(ends: Ends) -> None:
    ends.link.send(Bypass())
    ends.clock.advance_ns(10**12)
    assert ends.done() == {loop.Bypass}


def test_an_arm_before_the_first_good_reading_goes_on_with_it(ends: Ends) -> None:
    """A control process that has just begun does not refuse what it cannot judge yet."""
    ends.guard.has_connected = False
    ends.guard.state = State.FAULT
    ends.ask(Arm())
    assert ends.done() == set()
    ends.guard.has_connected = True
    assert ends.done() == {loop.Arm}
    assert ends.done() == set()


@pytest.mark.parametrize(
    "meanwhile", [Bypass(), Shadow(id=7, valid_until_ns=10**15)], ids=["bypass", "shadow"]
)
def test_what_comes_after_an_early_arm_ends_it(ends: Ends, meanwhile: Bypass | Shadow) -> None:
    ends.guard.has_connected = False
    ends.ask(Arm())
    assert ends.done() == set()
    ends.link.send(meanwhile)
    ends.done()
    ends.guard.has_connected = True
    assert ends.done() == set()


def test_an_early_arm_whose_time_is_over_does_not_arm(ends: Ends) -> None:
    ends.guard.has_connected = False
    ends.ask(Arm())
    assert ends.done() == set()
    ends.clock.advance_ns(int(PATIENCE_S * 1e9))
    ends.guard.has_connected = True
    assert ends.done() == set()


def test_an_early_arm_that_was_refused_does_not_arm_later(ends: Ends) -> None:
    ends.guard.has_connected = False
    ends.guard.state = State.FAULT
    ends.ask(Arm())
    assert ends.done() == set()
    for tick in range(ARM_PATIENCE_TICKS + 2):
        ends.tick(tick)
        assert ends.done() == set()
    replies = [said for said in ends.heard() if isinstance(said, Reply)]
    assert [(one.ok, one.message) for one in replies] == [(False, refused_arm(State.FAULT, ""))]
    ends.guard.has_connected = True
    assert ends.done() == set()
