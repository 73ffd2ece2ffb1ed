"""Who asks too often is bounded and counted, and takes nothing from anybody else."""

from __future__ import annotations

import socket
from dataclasses import replace

import pytest

from aff_runtime.app.hand.may import Action, Code, Place
from aff_runtime.app.hand.messages import LOGIN_REFUSED, Answer, Notice
from aff_runtime.app.link.peer import Peer
from aff_runtime.app.supervisor.hand.entries import ServiceState
from aff_runtime.app.supervisor.hand.visits import ScreenVisitor, Visits
from aff_runtime.base.errors import WireError
from aff_runtime.base.signals import State
from tests.aff_runtime.app.supervisor.hand.stand import Stand, code

S = 10**9


def test_a_flood_of_arms_is_bounded_counted_and_does_not_hold_up_a_bypass(stand: Stand) -> None:
    client = stand.client()
    for _ in range(90):
        client.say(stand.command(seen="ACTIVE"))
        stand.round()
    answers = [client.receive() for _ in range(90)]
    fast = [one for one in answers if isinstance(one, Answer) and code(one) is Code.FAST]
    assert len(fast) == 80
    client.say(stand.command(Action.BYPASS, seen="READY"))
    stand.round()
    assert stand.service.bypassed == 1
    assert len(stand.rows()) == 61
    stand.clock.advance_ns(34 * S)  # 0.03 lines/s of an account: room for one
    stand.round()
    assert stand.rows()[-1]["what"] == "more"
    assert stand.rows()[-1]["why"].startswith("30 more of anna, of uid ")


def test_a_flood_of_bypasses_costs_ten_a_second_and_the_last_is_done(stand: Stand) -> None:
    client = stand.client()
    for _ in range(50):
        client.say(stand.command(Action.BYPASS))
        stand.round()
        assert client.receive().ok  # type: ignore[union-attr]
    assert stand.service.bypassed == 10
    assert len(stand.rows()) == 50  # ten that may change something, the others of the sixty
    stand.clock.advance_ns(S // 10)
    stand.round()
    assert stand.service.bypassed == 11
    stand.clock.advance_ns(S)
    stand.round()
    assert stand.service.bypassed == 11


def test_a_flood_of_bypasses_of_one_user_costs_another_none_of_his(
    stand: Stand, monkeypatch: pytest.MonkeyPatch
) -> None:
    uids = iter((1001, 1002))

    def welcome(self: Visits, connection: socket.socket, peer: Peer) -> ScreenVisitor:
        return ScreenVisitor(connection, replace(peer, uid=next(uids)))

    monkeypatch.setattr(Visits, "_welcome", welcome)
    loud, calm = stand.client(), stand.client()
    stand.say(calm, Notice(what="hand taken", account="bert", place=Place.PANEL))
    for _ in range(30):
        stand.say(loud, stand.command(Action.BYPASS))
    assert stand.service.bypassed == 10  # the burst of one user
    for times in range(11, 21):
        stand.say(calm, stand.command(Action.BYPASS, account="bert"))
        assert stand.service.bypassed == times
    stand.clock.advance_ns(S // 10)
    stand.round()
    assert stand.service.bypassed == 20  # what waited was done by those


@pytest.mark.parametrize("state", [None, State.BYPASS])
def test_a_bypass_that_changes_nothing_is_counted_when_it_comes_too_often(
    stand: Stand, state: State | None
) -> None:
    stand.service.standing = ServiceState(state=state)
    for _ in range(100):
        client = stand.client()
        client.say(stand.command(Action.BYPASS))
        stand.round()
        client.close()
        stand.round()
    assert len(stand.rows()) == 60
    stand.clock.advance_ns(34 * S)
    stand.round()
    assert stand.rows()[-1]["why"].startswith("40 more of anna, of uid ")


def test_who_says_too_much_is_sent_away_but_his_bypass_is_done(stand: Stand) -> None:
    client = stand.client()
    for _ in range(101):
        client.say(stand.command(seen="OFF"))
        stand.round()
    with pytest.raises(WireError):
        client.say(stand.command())
    late = stand.client()
    late.say(stand.command(Action.BYPASS))
    stand.round()
    assert stand.service.bypassed == 1


def test_failed_logins_of_strangers_push_nobody_else_out_of_the_audit(stand: Stand) -> None:
    """Five hundred guesses within a moment; then people of the line do their work."""
    client = stand.client()
    for n in range(500):
        client.say(Notice(what=LOGIN_REFUSED, account=f"guess{n}", place=Place.NETWORK))
        stand.round()
    assert len(stand.rows()) == 20
    for n in range(60):
        client.say(Notice(what="login", account=f"person{n}", place=Place.PANEL))
        stand.round()
    assert sum(row["account"].startswith("person") for row in stand.rows()) == 60
    stand.say(client, stand.command(account="anna"))
    assert stand.rows()[-1]["account"] == "anna"
    stand.clock.advance_ns(50 * S)  # 0.02 lines/s: room for one
    stand.round()
    (more,) = [row for row in stand.rows() if row["what"] == "more"]
    assert more["why"].startswith("480 more refused logins of uid ")
