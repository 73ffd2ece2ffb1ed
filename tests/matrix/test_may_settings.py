"""``may`` against the service: what it says of try, keep and undo is what the desk answers.

The settings' desk of the supervisor answers in virtual time; nothing is real time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from aff_runtime.app.hand.may import (
    OF_SETTINGS,
    Action,
    Circumstances,
    Code,
    Person,
    Place,
    Role,
    may,
)
from aff_runtime.app.supervisor import edit_session
from aff_runtime.app.supervisor.settings import desk as settings_desk
from aff_runtime.base.signals import State
from tests.aff_runtime.app.supervisor.settings.rig import AtOnce, Rig
from tests.each_case import each_case

OWN = Person(role=Role.OPERATE, place=Place.PANEL, has_hand=True)
CARL = replace(OWN, role=Role.COMMISSION)
OTHER = ("settle_s: 6,", "settle_s: 12,"), ("settle_s: 6,", "settle_s: 9,")
SETTINGS_CELLS = [
    (Circumstances(state=state, remote=remote, probing=probing, trying=trying), action)
    for state in (None, State.READY, State.ACTIVE)
    for remote in (False, True)
    for probing in (False, True)
    for trying in (False, True)
    for action in OF_SETTINGS
]


@pytest.fixture
def desks(tmp_path, monkeypatch) -> Callable[[bool], Rig]:
    """Return what makes a settings' desk, with a try under way or without one."""
    for module in (settings_desk, edit_session):
        monkeypatch.setattr(module, "Validation", AtOnce)
    made: list[Rig] = []

    def desk(trying: bool) -> Rig:
        folder = tmp_path / str(len(made))
        folder.mkdir()
        made.append(Rig(folder))
        if trying:
            made[-1].begin(made[-1].other(*OTHER[0]))
            assert made[-1].desk.trying
        return made[-1]

    return desk


def answered(rig: Rig, now: Circumstances, action: Action) -> dict[str, object]:
    rig.now = now
    said = rig.ask(act=action.value, text=rig.other(*OTHER[1]), seconds=60.0, why="it is better")
    rig.run(0.3)
    return said.json


def test_what_may_says_of_settings_is_what_the_service_answers(desks) -> None:
    """What is refused changes nothing, so that one desk can be asked for all of that."""
    standing = {trying: desks(trying) for trying in (False, True)}
    done = set()
    for now, action in SETTINGS_CELLS:
        reasons = may(action, CARL, replace(now, ceiling=Role.COMMISSION))
        if reasons:
            answer = answered(standing[now.trying], now, action)
            assert not answer["ok"], (now, action)
            assert answer["message"] == reasons[0].text
        elif (now.trying, action) not in done:
            done.add((now.trying, action))
            answer = answered(desks(now.trying), now, action)
            nothing_before = action is Action.UNDO and not now.trying
            assert answer["ok"] or (nothing_before and "no version" in str(answer["message"]))
    assert {action for _, action in done} == set(OF_SETTINGS)
    assert standing[True].desk.trying  # no refusal has ended the try


def test_in_remote_nothing_is_tried_or_kept_and_the_way_back_is_open() -> None:
    now = Circumstances(state=State.ACTIVE, ceiling=Role.COMMISSION, remote=True)
    assert [r.code for r in may(Action.TRY, CARL, now)] == [Code.REMOTE]
    tried = replace(now, trying=True)
    assert [r.code for r in may(Action.KEEP, CARL, tried)] == [Code.REMOTE]
    assert may(Action.UNDO, CARL, tried) == ()


@each_case("action", OF_SETTINGS)
def test_settings_are_for_who_commissions_and_has_the_hand_at_the_panel(action) -> None:
    now = Circumstances(
        state=State.ACTIVE, ceiling=Role.COMMISSION, trying=action not in (Action.TRY, Action.SAVE)
    )
    assert may(action, CARL, now) == ()
    cells = {
        Code.SETTINGS_ROLE: (OWN, now),
        Code.NO_SETTINGS: (CARL, replace(now, ceiling=Role.OPERATE)),
        Code.PLACE: (replace(CARL, place=Place.NETWORK), now),
        Code.IDLE: (replace(CARL, is_idle=True), now),
        Code.NO_HAND: (replace(CARL, has_hand=False), now),
        Code.OTHER_HAND: (replace(CARL, has_hand=False), replace(now, hand_of="anna")),
        Code.LOGGED_OUT: (replace(CARL, role=None), now),
    }
    for code, (person, then) in cells.items():
        assert [reason.code for reason in may(action, person, then)] == [code]
