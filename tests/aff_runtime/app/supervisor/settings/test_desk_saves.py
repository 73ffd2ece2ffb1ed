"""What waits for bypass is saved with who and why; what a try's end leaves of `undo`."""

from __future__ import annotations

import pytest

from aff_runtime.app.supervisor import edit_session
from aff_runtime.app.supervisor.settings import desk as desk_module
from aff_runtime.base.text_digest import text_digest
from tests.aff_runtime.app.supervisor.settings.rig import WHO, AtOnce, Rig

CYCLE = ("cycle_ms: 5", "cycle_ms: 10")
WHY = "the PLC scans every 10 ms"


@pytest.fixture
def rig(tmp_path, monkeypatch):
    for module in (desk_module, edit_session):
        monkeypatch.setattr(module, "Validation", AtOnce)
    return Rig(tmp_path)


def saved(rig: Rig, text: str, **more: str) -> str:
    """Ask for a text to be saved, and save what is handed out."""
    asked = rig.ask(act="save", text=text, why=WHY, **more)
    rig.run(0.2)
    assert asked.json["ok"], asked.json
    assert asked.json["replaces"] == text_digest(rig.site.read_text())
    rig.site.write_text(asked.text)
    rig.run(0.5)
    return asked.text


def state(rig: Rig) -> dict[str, object]:
    return rig.ask(act="state").json


def test_it_waits_while_a_correction_goes_out_and_is_taken_at_bypass_minutes_later(rig) -> None:
    text = rig.other(*CYCLE)
    assert saved(rig, text) == text
    assert rig.runs_the_former
    assert state(rig)["waiting"] == text_digest(text)
    rig.run(120.0)
    assert rig.runs_the_former
    rig.running.live = False
    rig.run(0.5)
    assert rig.running.starts == [text]  # idle, on the new settings
    assert state(rig)["waiting"] == ""
    last = rig.ask(act="history").json["versions"][-1]
    assert (last["verb"], last["who"], last["why"]) == ("edited", WHO, WHY)


def test_at_bypass_it_is_taken_at_once(rig) -> None:
    rig.running.live = False
    text = rig.other(*CYCLE)
    saved(rig, text)
    assert rig.running.starts == [text]
    assert rig.rows[-1] == ("edited", WHY)


def test_what_waits_can_be_replaced_and_taken_back_before_the_bypass(rig) -> None:
    first = rig.other(*CYCLE)
    saved(rig, first)
    second = rig.other("cycle_ms: 5", "cycle_ms: 20")
    saved(rig, second, base=text_digest(first))
    assert state(rig)["waiting"] == text_digest(second)
    asked = rig.ask(act="undo", why="wrong after all")
    assert (asked.text, asked.json["replaces"]) == (rig.former, text_digest(second))
    rig.site.write_text(asked.text)
    rig.run(0.5)
    assert state(rig)["waiting"] == ""
    rig.running.live = False
    rig.run(0.5)
    assert rig.running.starts == []
    assert rig.running.parameters.site_text == rig.former


@pytest.mark.parametrize(
    ("text", "more", "said"),
    [
        ("", {}, "nothing differs from what is saved"),
        ("cycle_ms: 9999", {}, "line.cycle_ms"),
        ("cycle_ms: 10", {"base": "0" * 64}, "somebody has saved other settings"),
    ],
)
def test_what_cannot_be_saved_says_why(rig, text, more, said) -> None:
    asked = rig.ask(
        act="save", text=rig.other("cycle_ms: 5", text or "cycle_ms: 5"), why=WHY, **more
    )
    rig.run(0.2)
    assert not asked.json["ok"]
    assert said in asked.json["message"]
    assert rig.site.read_text() == rig.former


def test_nothing_is_saved_over_a_try_or_an_edit_of_somebody_else(rig) -> None:
    rig.begin()
    asked = rig.ask(act="save", text=rig.other(*CYCLE), why=WHY)
    assert "keep or undo them first" in asked.json["message"]
    rig.ask(act="undo", why="enough seen")
    rig.run(0.3)
    rig.site.write_text(rig.former + "# saved a moment ago\n")
    asked = rig.ask(act="save", text=rig.other(*CYCLE), why=WHY)
    assert "is not what runs" in asked.json["message"]


def test_an_undo_that_comes_after_a_trys_end_is_refused_and_names_the_version_before(rig) -> None:
    rig.site.write_text(rig.other())
    rig.run(1.0)
    rig.begin(rig.other("settle_s: 6,", "settle_s: 9,"), seconds=5.0)
    rig.run(6.0)
    assert rig.rows[-1] == ("returned", "its time is up")
    refused = rig.ask(act="undo", why="it hunts still").json
    assert not refused["ok"]
    assert "the try has ended already (its time is up)" in refused["message"]
    assert "undo SITE.yaml 1 --why" in refused["message"]
    asked = rig.ask(act="undo", why="it hunts still", version=1)
    assert asked.text == rig.former


def test_an_undo_while_a_try_returns_by_itself_is_told_what_ended_it(rig) -> None:
    rig.begin(seconds=5.0)
    rig.running.control.deaf = True
    rig.run(5.0)  # the former settings are handed over, and not taken yet
    asked = rig.ask(act="undo", why="it hunts still")
    rig.running.control.deaf = False
    rig.run(6.0)
    assert asked.json["remarks"] == ("its time is up",)
    assert rig.rows[-1] == ("returned", "its time is up")


def test_an_undo_between_a_trys_end_and_the_next_look_is_of_the_version_before(rig) -> None:
    rig.site.write_text(rig.other("settle_s: 6,", "settle_s: 9,"))
    rig.run(0.5)
    rig.begin(seconds=60.0)
    first = rig.ask(act="undo", why="enough seen")
    second = rig.ask(act="undo", why="enough seen")  # it has ended, and nobody has looked since
    assert first.json["remarks"] == (f"undone by {WHO}: enough seen",)
    assert second.text == rig.former
