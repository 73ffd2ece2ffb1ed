"""What a screen asks is done or refused, and put on record either way."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from aff_runtime.app.hand import messages
from aff_runtime.app.hand.audit import verify
from aff_runtime.app.hand.may import PROBES, Action, Code, Place, Role
from aff_runtime.app.hand.messages import VALID_NS, Answer, Notice
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.supervisor.hand import visits
from aff_runtime.app.supervisor.hand.desk import REMEMBERED_NS, HandRules
from aff_runtime.app.supervisor.hand.entries import ServiceState
from aff_runtime.app.supervisor.hand.visits import MAX_VISITORS
from aff_runtime.base.errors import WireError
from aff_runtime.base.signals import State
from tests.aff_runtime.app.supervisor.hand.stand import Stand, code

S = 10**9


def test_an_arm_is_put_on_record_asked_passed_on_and_answered(stand: Stand) -> None:
    client = stand.client()
    command = stand.command()
    assert stand.say(client, command) is None
    stand.service.answer()
    assert client.receive() == Answer(id=command.id, ok=True, audit=2)
    asked, done = stand.rows()
    assert (asked["result"], done["result"]) == ("asked", "done")
    assert asked["account"] == "anna"
    assert asked["peer"].startswith(f"uid {os.geteuid()}")
    assert (asked["seen"], asked["state"], asked["tick"], asked["config"]) == (
        *("READY", "READY"),
        *(7, "3f9a"),
    )
    assert verify(stand.audit.path).last == 2
    assert stand.audit.newest[:12] in stand.service.notes[-1]


def test_a_refusal_of_the_guard_comes_in_its_own_words(stand: Stand) -> None:
    client = stand.client()
    stand.say(client, stand.command())
    stand.service.answer(ok=False, message="READY: blocked by WEB_INTACT=0")
    answer = client.receive()
    assert isinstance(answer, Answer)
    assert code(answer) is Code.REFUSED
    assert answer.reason is not None
    assert answer.reason.text == "refused: READY: blocked by WEB_INTACT=0"
    assert stand.rows()[-1]["why"] == "READY: blocked by WEB_INTACT=0"


@pytest.mark.parametrize(
    ("action", "seen", "shadows"),
    [("shadow", "READY", [True]), ("end-shadow", "SHADOW", [False]), ("forget", "READY", [])],
)
def test_shadow_and_forgetting_are_passed_on_answered_and_on_record(
    stand: Stand, action: str, seen: str, shadows: list[bool]
) -> None:
    client = stand.client()
    stand.service.standing = replace(stand.service.standing, state=State[seen])
    command = stand.command(Action(action), seen=seen)
    assert stand.say(client, command) is None
    stand.service.answer()
    assert client.receive() == Answer(id=command.id, ok=True, audit=2)
    assert stand.service.shadows == shadows
    assert [(row["what"], row["result"]) for row in stand.rows()] == [
        (action, "asked"),
        (action, "done"),
    ]


@pytest.mark.parametrize("action", [Action.SHADOW, Action.FORGET])
def test_in_remote_they_are_refused(stand: Stand, action: Action) -> None:
    client = stand.client()
    stand.service.standing = replace(stand.service.standing, remote=True)
    assert code(stand.say(client, stand.command(action))) is Code.REMOTE
    assert stand.service.asked == []


SPOILT: dict[str, tuple[Callable[[Stand], dict[str, object]], Code]] = {
    "late": (lambda s: {"valid_until_ns": s.clock.now_ns() - 1}, Code.LATE),
    "valid for too long": (
        lambda s: {"valid_until_ns": s.clock.now_ns() + VALID_NS + 1},
        Code.LATE,
    ),
    "another state": (lambda s: {"seen": "BYPASS"}, Code.CHANGED),
    "no state seen": (lambda s: {"seen": ""}, Code.CHANGED),
    "view": (lambda s: {"role": Role.VIEW}, Code.ROLE),
    "from the network": (lambda s: {"place": Place.NETWORK}, Code.PLACE),
}


@pytest.mark.parametrize(("spoil", "why"), SPOILT.values(), ids=SPOILT)
def test_what_does_not_fit_is_refused_and_recorded(
    stand: Stand, spoil: Callable[[Stand], dict[str, object]], why: Code
) -> None:
    answer = stand.say(stand.client(), stand.command(**spoil(stand)))
    assert code(answer) is why
    assert not stand.service.asked
    (row,) = stand.rows()
    assert row["result"] == "refused"
    assert row["why"] == answer.reason.text  # type: ignore[union-attr]


def test_every_command_is_counted_once_by_what_became_of_it(stand: Stand) -> None:
    client = stand.client()
    first = stand.command()
    stand.say(client, first)
    stand.service.answer()
    client.receive()
    assert code(stand.say(client, first)) is Code.REPEATED
    stand.say(client, stand.command())
    stand.service.answer(ok=False, message="READY: blocked by WEB_INTACT=0")
    client.receive()
    stand.say(client, stand.command(valid_until_ns=stand.clock.now_ns() - 1))
    stand.say(client, stand.command(role=Role.VIEW))
    stand.say(client, stand.command(Action.BYPASS))
    counted = {(one.action, one.via, one.result): one.count for one in stand.counts.rows()}
    assert counted == {
        ("arm", "hmi", "done"): 1,
        ("arm", "hmi", "late"): 1,
        ("arm", "hmi", "refused"): 2,
        ("arm", "hmi", "repeated"): 1,
        ("bypass", "hmi", "done"): 1,
    }


def test_an_id_does_nothing_a_second_time_however_it_is_dressed(stand: Stand) -> None:
    client = stand.client()
    command = stand.command()
    stand.say(client, command)
    stand.service.answer()
    client.receive()
    for step_ns in (0, VALID_NS, REMEMBERED_NS // 2):
        stand.clock.advance_ns(step_ns)
        again = replace(command, account="bert", valid_until_ns=stand.clock.now_ns() + 1)
        assert code(stand.say(client, again)) is Code.REPEATED
    assert not stand.service.asked
    stand.clock.advance_ns(REMEMBERED_NS)
    assert code(stand.say(client, command)) is Code.LATE
    stand.say(client, stand.command())
    assert len(stand.desk._ids) == 1


@pytest.mark.parametrize("whose", ["another screen", "the console"])
def test_an_arm_of_what_was_seen_before_a_bypass_does_not_undo_it(
    stand: Stand, whose: str
) -> None:
    stand.service.standing = ServiceState(state=State.BYPASS)
    client, other = stand.client(), stand.client()
    pressed_first = stand.command(seen="BYPASS")
    stand.clock.advance_ns(S)
    if whose == "another screen":
        stand.say(other, stand.command(Action.BYPASS))
    else:
        stand.service.bypass()
    assert code(stand.say(client, pressed_first)) is Code.LATE
    assert not stand.service.asked
    stand.say(client, stand.command(seen="BYPASS"))
    assert stand.service.asked


@pytest.mark.parametrize("ceiling", Role)
def test_the_ceiling_holds_against_every_role_that_is_claimed(
    tmp_path: Path, ceiling: Role
) -> None:
    with contextlib.closing(Stand(tmp_path, HandRules(ceiling=ceiling))) as stand:
        answer = stand.say(stand.client(), stand.command(role=Role.COMMISSION))
        if ceiling is Role.VIEW:
            assert code(answer) is Code.CEILING
        assert bool(stand.service.asked) is (ceiling is not Role.VIEW)


def test_from_the_network_only_where_the_service_says_so(tmp_path: Path) -> None:
    rules = HandRules(ceiling=Role.OPERATE, commands_from=Place.NETWORK)
    with contextlib.closing(Stand(tmp_path, rules)) as stand:
        stand.say(stand.client(), stand.command(place=Place.NETWORK))
        assert stand.service.asked


def test_what_the_guard_is_known_to_refuse_is_not_asked(stand: Stand) -> None:
    stand.service.standing = ServiceState(state=State.READY, blocked="WEB_INTACT=0")
    answer = stand.say(stand.client(), stand.command())
    assert code(answer) is Code.GUARD
    stand.service.standing = ServiceState(state=None)
    assert code(stand.say(stand.client(), stand.command())) is Code.SILENT


@pytest.mark.parametrize("state", [None, *State])
@pytest.mark.parametrize("role", Role)
@pytest.mark.parametrize("place", Place)
def test_a_bypass_is_done_whatever_it_carries(
    stand: Stand, state: State | None, role: Role, place: Place
) -> None:
    stand.service.standing = ServiceState(
        state=state, blocked="REMOTE=1: the PLC arms, by its reset"
    )
    client = stand.client()
    late = stand.command(
        Action.BYPASS, role=role, place=place, seen="ACTIVE", valid_until_ns=0, id="a" * 16
    )
    for times in (1, 2):
        answer = stand.say(client, late)
        assert answer is not None
        assert answer.ok
        assert stand.service.bypassed == times


def test_what_no_hand_does_is_refused_and_on_record_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else it would be asked on record, and never answered."""
    monkeypatch.setattr(messages, "BY_HAND", tuple(Action))
    rules = HandRules(ceiling=Role.COMMISSION)
    with contextlib.closing(Stand(tmp_path, rules)) as stand:
        command = stand.command(Action.UNDO, role=Role.COMMISSION)
        assert code(stand.say(stand.client(), command)) is Code.REFUSED
        assert [row["result"] for row in stand.rows()] == ["asked", "refused"]


@pytest.mark.parametrize("packet", [b"{}", b"\xff", b"x" * 3000, b'{"say":"command"}', b"null"])
def test_who_says_no_request_is_recorded_and_sent_away(stand: Stand, packet: bytes) -> None:
    client = stand.client()
    client._socket.send(packet)
    stand.round()
    with pytest.raises(WireError):
        client.receive()
    assert stand.rows()[-1]["what"] == "no command"


def test_sessions_are_noted(stand: Stand) -> None:
    stand.say(stand.client(), Notice(what="hand taken", account="anna", place=Place.PANEL))
    (row,) = stand.rows()
    assert (row["what"], row["result"], row["account"]) == ("hand taken", "noted", "anna")


def test_who_leaves_before_the_answer_disturbs_nobody(stand: Stand) -> None:
    client = stand.client()
    stand.say(client, stand.command())
    client.close()
    stand.round()
    stand.service.answer()
    assert stand.rows()[-1]["result"] == "done"


def test_the_first_goes_when_there_are_too_many(stand: Stand) -> None:
    clients = [stand.client() for _ in range(MAX_VISITORS + 1)]
    with pytest.raises(WireError):
        clients[0].receive()
    assert clients[1].receive() is None


def test_a_user_who_is_none_of_ours_is_not_let_in(
    stand: Stand, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(visits, "screen_uids", frozenset)
    end = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    end.connect(str(stand.path))
    stand.round()
    assert end.recv(100) == b""
    end.close()


def test_the_socket_is_for_our_own_user_alone(stand: Stand) -> None:
    assert stand.path.stat().st_mode & 0o777 == 0o600
    assert stand.audit.path.stat().st_mode & 0o777 == 0o600
    assert stand.audit.path.parent.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("action", PROBES)
def test_a_probe_is_for_the_role_commission_at_a_service_that_lets_screens_commission(
    tmp_path: Path, action: Action
) -> None:
    for folder, ceiling in (("open", Role.COMMISSION), ("closed", Role.OPERATE)):
        (tmp_path / folder).mkdir()
        with contextlib.closing(Stand(tmp_path / folder, HandRules(ceiling=ceiling))) as stand:
            client = stand.client()
            asked = stand.command(action, role=Role.COMMISSION)
            if ceiling is Role.OPERATE:
                assert code(stand.say(client, asked)) is Code.NO_PROBE
                assert not stand.service.probes
                continue
            assert code(stand.say(client, stand.command(action))) is Code.PROBE_ROLE
            assert stand.say(client, asked) is None
            stand.service.probes.pop()(Reply(id=1, ok=True))
            assert stand.service.louder == [action is Action.PROBE_LOUDER]
            assert client.receive() == Answer(id=asked.id, ok=True, audit=3)
            assert not stand.service.asked
