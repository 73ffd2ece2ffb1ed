"""A bypass overtakes the requests to arm that were made before it, and no later one."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from aff_runtime.app.control.commands import Commands
from aff_runtime.app.link.packets import Link, link_pair


@pytest.fixture
def ends() -> Iterator[tuple[Link, Link]]:
    a, b = (Link(end) for end in link_pair())
    yield a, b
    a.close()
    b.close()


def _said(ends: tuple[Link, Link], *messages: str) -> Commands:
    for number, do in enumerate(messages):
        assert ends[0].send({"do": do, "id": number})
    return Commands(ends[1])


def _rest(commands: Commands) -> list[str]:
    found = []
    while (said := commands.next()) is not None:
        found.append(said["do"])
    return found


def test_without_a_bypass_commands_come_in_order(ends: tuple[Link, Link]) -> None:
    commands = _said(ends, "ARM", "DIFFERS", "BYPASS")
    assert _rest(commands) == ["ARM", "DIFFERS", "BYPASS"]


def test_a_queue_of_arms_does_not_undo_the_bypass_behind_it(ends: tuple[Link, Link]) -> None:
    commands = _said(ends, "ARM", "ARM", "PROBE", "PARAMS", "BYPASS")
    assert [said["id"] for said in commands.overtake()] == [0, 1, 2]
    assert _rest(commands) == ["PARAMS", "BYPASS"]


def test_an_arm_after_the_bypass_counts(ends: tuple[Link, Link]) -> None:
    commands = _said(ends, "ARM", "BYPASS", "ARM")
    assert [said["id"] for said in commands.overtake()] == [0]
    assert _rest(commands) == ["BYPASS", "ARM"]


def test_a_bypass_by_signal_alone_overtakes_everything_that_waits(ends: tuple[Link, Link]) -> None:
    commands = _said(ends, "ARM", "STOP")
    ends[0].close()
    assert [said["do"] for said in commands.overtake()] == ["ARM"]
    assert commands.next() == {"do": "STOP", "id": 1}
