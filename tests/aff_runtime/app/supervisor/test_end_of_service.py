"""Whoever asked for something is told what became of it, though the service or its child ends."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.app.hand.audit import NAME, verify
from aff_runtime.app.hand.client import HandClient
from aff_runtime.app.hand.may import Action, Place, Role
from aff_runtime.app.hand.messages import VALID_NS, Answer, Command, Welcome
from aff_runtime.app.link.messages import Arm, Message
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.supervisor.control_child import Ending
from aff_runtime.base.signals import State
from tests.aff_runtime.app.supervisor.whole import Whole


class Pressed:
    """A service at which a screen has pressed ARM, and nothing was answered yet."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self._folder = folder
        self.whole = Whole(folder, monkeypatch, hand=Role.OPERATE)
        self.whole.tick(State.READY)
        self.screen = HandClient(folder / "run" / "hand.sock")
        self.whole.service._serve(0.0)
        assert isinstance(self.screen.receive(), Welcome)
        command = Command(
            id="a" * 16,
            action=Action.ARM,
            account="anna",
            role=Role.OPERATE,
            place=Place.PANEL,
            seen="READY",
            valid_until_ns=self.whole.clock.now_ns() + VALID_NS,
        )
        self.screen.say(command)
        self.whole.service._serve(0.0)
        assert self.outcomes() == [("asked", "")]
        self.asked = self.whole.control.sent[-1]
        assert isinstance(self.asked, Arm)

    @property
    def audit(self) -> Path:
        (path,) = (self._folder / "state" / "audit").glob(f"*/{NAME}")
        return path

    def outcomes(self) -> list[tuple[str, str]]:
        rows: list[dict[str, Any]] = list(map(json.loads, self.audit.read_text().splitlines()))
        return [(row["result"], row["why"]) for row in rows if row["what"] == "arm"]

    def told(self) -> Answer:
        found = self.screen.receive()
        assert isinstance(found, Answer)
        return found


@pytest.fixture
def pressed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Pressed]:
    found = Pressed(tmp_path, monkeypatch)
    yield found
    found.screen.close()
    found.whole.stop()


LAST_WORDS: dict[str, tuple[Callable[[int], list[Message]], tuple[str, str]]] = {
    "nothing": (lambda _: [], ("refused", "the service stops")),
    "armed": (lambda ident: [Reply(id=ident, ok=True, state="ARMED")], ("done", "")),
    "refused": (
        lambda ident: [Reply(id=ident, ok=False, message="READY: not armed")],
        ("refused", "READY: not armed"),
    ),
}


@pytest.mark.parametrize(("says", "became"), LAST_WORDS.values(), ids=LAST_WORDS)
def test_the_audit_has_an_outcome_of_what_was_asked_before_the_service_stops(
    pressed: Pressed, says: Callable[[int], list[Message]], became: tuple[str, str]
) -> None:
    pressed.whole.control.last_words = lambda: says(pressed.asked.id)
    pressed.whole.stop()
    assert pressed.outcomes() == [("asked", ""), became]
    assert pressed.told().ok is (became[0] == "done")
    assert verify(pressed.audit).wrong == ""


@pytest.mark.parametrize(
    ("ending", "code", "claims"),
    [(Ending.ZERO, 0, True), (Ending.UNHEARD, 5, False), (Ending.BADLY, 5, False)],
)
def test_the_zero_is_claimed_only_where_it_is_known(
    pressed: Pressed, caplog: pytest.LogCaptureFixture, ending: Ending, code: int, claims: bool
) -> None:
    pressed.whole.control.ending = ending
    with caplog.at_level("INFO", logger="aff_runtime"):
        pressed.whole.stop()
    assert pressed.whole.service._exit_code == code
    assert ("reached zero" in caplog.text) is claims
    assert ("no answer of the PLC" in caplog.text) is (ending is Ending.UNHEARD)
    assert ("did not end in good order" in caplog.text) is (ending is Ending.BADLY)


def test_a_control_process_that_is_exchanged_has_answered_or_is_answered_for(
    pressed: Pressed,
) -> None:
    """An arm is not left without an answer until its time is over, and is not done by the next."""
    pressed.whole.service._edits.restart_on(pressed.whole.children.parameters)
    refused = ("refused", "the control process starts anew")
    assert pressed.outcomes() == [("asked", ""), refused]
    assert not pressed.told().ok
    assert not any(isinstance(said, Arm) for said in pressed.whole.control.sent)


def test_a_death_is_the_outcome(pressed: Pressed) -> None:
    pressed.whole.control.how_it_ended = "killed by SIGKILL"
    pressed.whole.round()
    assert pressed.outcomes()[-1] == ("refused", "the control process died; see the log")
