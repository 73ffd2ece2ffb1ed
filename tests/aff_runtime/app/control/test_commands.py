"""A bypass overtakes the requests to arm that were made before it, and no later one."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from aff_runtime.app.control.commands import CommandQueue
from aff_runtime.app.link.messages import (
    Arm,
    Bypass,
    ConfigDiffers,
    MeasureResponse,
    Message,
    Parameters,
    Stop,
)
from aff_runtime.app.link.packets import Link, link_pair
from tests.parameter_records import record_of


@pytest.fixture
def ends() -> Iterator[tuple[Link, Link]]:
    a, b = (Link(end) for end in link_pair())
    yield a, b
    a.close()
    b.close()


def _said(ends: tuple[Link, Link], *said: Message) -> CommandQueue:
    for message in said:
        assert ends[0].send(message)
    return CommandQueue(ends[1])


def _rest(commands: CommandQueue) -> list[Message]:
    found = []
    while (said := commands.next()) is not None:
        found.append(said)
    return found


def test_without_a_bypass_commands_come_in_order(ends: tuple[Link, Link]) -> None:
    commands = _said(ends, Arm(id=0), ConfigDiffers(), Bypass())
    assert _rest(commands) == [Arm(id=0), ConfigDiffers(), Bypass()]


def test_a_queue_of_arms_does_not_undo_the_bypass_behind_it(ends: tuple[Link, Link]) -> None:
    edit = Parameters(id=3, record=record_of())
    commands = _said(ends, Arm(id=0), Arm(id=1), MeasureResponse(id=2), edit, Bypass())
    assert [said.id for said in commands.overtake()] == [0, 1, 2]
    assert _rest(commands) == [edit, Bypass()]


def test_an_arm_after_the_bypass_counts(ends: tuple[Link, Link]) -> None:
    commands = _said(ends, Arm(id=0), Bypass(), Arm(id=2))
    assert [said.id for said in commands.overtake()] == [0]
    assert _rest(commands) == [Bypass(), Arm(id=2)]


def test_a_bypass_by_signal_alone_overtakes_everything_that_waits(ends: tuple[Link, Link]) -> None:
    commands = _said(ends, Arm(id=0), Stop())
    ends[0].close()
    assert commands.overtake() == [Arm(id=0)]
    assert commands.next() == Stop()


def test_what_is_no_message_is_passed_over_and_the_next_one_counts() -> None:
    ours, theirs = link_pair()
    ours.send(b"not json")
    ours.send(b'{"word": "Arm", "valid_until_ns": 1}')  # no id
    ours.send(b'{"word": "Arm", "id": 1}')  # of a release that asks without end
    link = Link(ours)
    assert link.send(Bypass())
    assert CommandQueue(Link(theirs)).next() == Bypass()
    link.close()
    theirs.close()
