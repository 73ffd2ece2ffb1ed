"""A disk that is full: what is not on record is in the log, and how much it was in the audit."""

from __future__ import annotations

import pytest

from aff_runtime.app.hand.audit import verify
from aff_runtime.app.hand.audit_writer import RETRY_NS
from aff_runtime.app.hand.may import Action, Code, Place
from aff_runtime.app.hand.messages import Notice
from aff_runtime.base.errors import RefusedError
from tests.aff_runtime.app.supervisor.hand.stand import Stand


def full(entry: object) -> int:
    raise RefusedError("No space left on device")


def test_without_a_record_nothing_arms_and_a_bypass_is_still_done(
    stand: Stand, monkeypatch: pytest.MonkeyPatch
) -> None:
    client = stand.client()

    monkeypatch.setattr(stand.audit, "add", full)
    answer = stand.say(client, stand.command())
    assert answer is not None
    assert answer.reason is not None
    assert answer.reason.code is Code.UNRECORDED
    assert not stand.service.asked
    answer = stand.say(client, stand.command(Action.BYPASS))
    assert answer is not None
    assert (answer.ok, answer.audit, stand.service.bypassed) == (True, 0, 1)
    assert not stand.desk.is_kept
    arm, bypass = stand.service.notes
    assert 'arm asked by "anna" of a screen' in arm
    assert 'bypass done by "anna" of a screen' in bypass
    assert bypass.endswith("; not in the audit")
    monkeypatch.undo()
    assert not stand.desk.is_kept
    stand.say(stand.client(), stand.command(Action.BYPASS))
    assert stand.desk.is_kept
    lost, done = stand.rows()
    assert (lost["what"], lost["why"]) == ("lost", "2 lines could not be written")
    assert (done["what"], done["result"]) == ("bypass", "done")
    assert verify(stand.audit.path).last == 2


def test_lines_that_were_lost_are_told_without_a_press_and_before_all_else(
    stand: Stand, monkeypatch: pytest.MonkeyPatch
) -> None:
    client = stand.client()
    with monkeypatch.context() as broken:
        broken.setattr(stand.audit, "add", full)
        for _ in range(7):
            client.say(Notice(what="hand taken", account="anna", place=Place.PANEL))
            stand.round()
        assert not stand.desk.is_kept
        stand.round()
    assert len(stand.service.notes) == 7
    stand.clock.advance_ns(RETRY_NS)
    stand.round()
    assert stand.desk.is_kept
    (lost,) = stand.rows()
    assert (lost["what"], lost["why"]) == ("lost", "7 lines could not be written")
