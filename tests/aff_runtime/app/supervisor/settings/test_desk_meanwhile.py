"""What others do meanwhile: nothing is kept, ended or tried that nobody has seen."""

from __future__ import annotations

import pytest

from aff_runtime.app.hand.may import Circumstances
from aff_runtime.app.supervisor import edit_session
from aff_runtime.app.supervisor.settings import desk as desk_module
from aff_runtime.app.supervisor.settings.ripple_rise import NOW_S, SETTLE_S
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.signals import State
from aff_runtime.base.text_digest import text_digest
from tests.aff_runtime.app.supervisor.settings.rig import AtOnce, Rig


@pytest.fixture
def rig(tmp_path, monkeypatch):
    for module in (desk_module, edit_session):
        monkeypatch.setattr(module, "Validation", AtOnce)
    return Rig(tmp_path)


def test_taking_back_a_try_that_has_ended_hands_out_no_earlier_version(rig):
    edited = rig.other("settle_s: 6,", "settle_s: 9,")
    rig.site.write_text(edited)
    rig.run(0.5)
    text = rig.other()
    rig.begin(text, seconds=5.0)
    assert rig.desk.tried == text_digest(text)
    rig.run(6.0)
    assert rig.desk.tried == ""
    assert rig.running.parameters.site_text == edited
    for act in ("undo", "keep"):
        said = rig.ask(act=act, why="web flutters", tried=text_digest(text))
        assert said.json["message"] == "no settings are being tried"
    said = rig.ask(act="undo", why="web flutters").json["message"]  # the console's own
    assert said.startswith("the try has ended already (its time is up)")
    assert rig.ask(act="undo", why="web flutters", version=1).text == rig.former


@pytest.mark.parametrize("act", ["keep", "undo"])
def test_what_is_kept_or_ended_is_the_try_that_was_seen(rig, act):
    seen, later = rig.other(), rig.other("settle_s: 6,", "settle_s: 9,")
    rig.begin(seen)
    rig.ask(act="undo", why="web flutters", tried=text_digest(seen))
    rig.run(0.5)
    assert rig.runs_the_former
    rig.begin(later)
    said = rig.ask(act=act, why="3 dB less at 1x", tried=text_digest(seen))
    assert said.json["message"].startswith("other settings are being tried than those that you")
    rig.run(0.5)
    assert rig.running.parameters.site_text == later
    said = rig.ask(act=act, why="3 dB less at 1x", tried=text_digest(later))
    rig.run(0.5)
    assert said.json["ok"]
    assert (said.text, rig.runs_the_former) == ((later, False) if act == "keep" else ("", True))


def test_what_was_decided_on_other_settings_than_those_that_run_is_refused(rig):
    base = text_digest(rig.former)
    edited = rig.other("settle_s: 6,", "settle_s: 9,")
    rig.site.write_text(edited)
    rig.run(0.5)
    assert rig.running.parameters.site_text == edited
    late = rig.ask(act="try", text=rig.other(), seconds=60.0, why="hunting at 1x", base=base)
    back = rig.ask(act="undo", version=1, why="hunting at 1x", base=base)
    for said in (late, back):
        assert "somebody has saved other settings" in said.json["message"]
    assert rig.running.parameters.site_text == edited
    wrong = rig.ask(act="diff", text=rig.other())
    rig.run(0.2)
    assert wrong.json["ok"]
    now = text_digest(edited)
    assert rig.ask(act="undo", version=1, why="as it was", base=now).text == rig.former


def test_what_somebody_saves_while_a_try_is_checked_is_not_lost_by_it(rig):
    said = rig.ask(act="try", text=rig.other(), seconds=60.0, why="hunting at 1x")
    edited = rig.other("settle_s: 6,", "settle_s: 9,")
    rig.site.write_text(edited)
    for _ in range(5):
        rig.edits.step()
    assert rig.running.parameters.site_text == edited
    rig.run(0.5)
    assert "somebody has saved other settings" in said.json["message"]
    assert rig.running.parameters.site_text == edited


def test_a_comment_that_was_saved_by_hand_runs_as_a_version_and_can_be_tried_on(rig):
    text = rig.former + "# seen on the drive\n"
    rig.site.write_text(text)
    rig.run(0.5)
    assert rig.running.parameters.site_text == text
    assert rig.running.control.taken == []  # no value of it is another one
    row = rig.ask(act="history").json["versions"][-1]
    assert (row["verb"], row["sha256"]) == ("edited", text_digest(text))
    other = text.replace("settle_s: 6,", "settle_s: 12,", 1)
    assert rig.begin(other).json["ok"]
    rig.ask(act="undo", why="enough seen")
    rig.run(0.5)
    assert rig.running.parameters.site_text == text
    assert rig.ask(act="undo", why="as it was").text == rig.former


def test_a_line_that_went_to_remote_while_a_try_was_checked_is_the_plcs(rig):
    said = rig.ask(act="try", text=rig.other(), seconds=60.0, why="hunting at 1x")
    rig.now = Circumstances(state=State.ACTIVE, remote=True)
    rig.run(0.5)
    assert said.json["message"].startswith("the line is in remote")
    assert (rig.running.control.taken, rig.desk.trying) == ([], "")


def test_a_correction_that_was_taken_back_while_a_try_was_checked_is_not_tried_on(rig):
    said = rig.ask(act="try", text=rig.other(), seconds=60.0, why="hunting at 1x")
    rig.running.live = False
    rig.run(0.5)
    assert said.json["message"] == "the correction was taken back meanwhile; look again"
    assert (rig.running.control.taken, rig.desk.trying) == ([], "")
    assert rig.begin().json["ok"]  # of who asks while nothing goes out


def test_who_looks_at_a_difference_holds_up_neither_undo_nor_a_probe(rig):
    edited = rig.other("settle_s: 6,", "settle_s: 9,")
    rig.site.write_text(edited)
    rig.run(0.5)
    looked = rig.ask(act="diff", text=rig.former)
    rig.desk.refuse_while_trying()  # as a probe asks it
    assert rig.ask(act="undo", why="web flutters").text == rig.former
    assert looked.said is None
    rig.run(0.2)
    assert looked.json["changes"]


def test_a_try_does_not_wait_for_who_looks_at_a_difference(rig):
    looked = rig.ask(act="diff", text=rig.former)
    tried = rig.begin()
    assert tried.json["ok"]
    assert looked.json["message"] == "other settings are being checked; try again"
    rig.ask(act="undo", why="enough seen")
    rig.run(0.5)
    first = rig.ask(act="try", text=rig.other(), seconds=60.0, why="hunting at 1x")
    assert "being checked" in rig.ask(act="diff", text=rig.former).json["message"]
    with pytest.raises(RefusedError, match="being tried"):
        rig.desk.refuse_while_trying()
    rig.run(0.5)
    assert first.json["ok"]


def test_going_back_to_a_version_does_not_end_a_try_instead(rig):
    rig.begin()
    running = text_digest(rig.other())
    said = rig.ask(act="undo", version=1, why="as it was", base=running)
    assert "a try runs: end it first" in said.json["message"]
    assert rig.running.parameters.site_text == rig.other()


def test_a_keep_that_nobody_saves_holds_a_try_up_once(rig):
    rig.begin(seconds=10.0)
    rig.run(8.5)
    for _ in range(4):  # 12 s from the first on, of which KEEP_GRACE_S are granted
        rig.ask(act="keep", why="3 dB less at 1x")
        rig.run(3.0)
    assert rig.runs_the_former
    assert rig.rows[-1] == ("returned", "its time is up")


def test_what_is_taken_back_already_is_not_kept(rig):
    """Ripple rose, and the control process has not answered yet: the text is not handed out."""
    rig.run(20.0)
    rig.begin()
    rig.running.ring.signals.amplitude_N = 4.0
    rig.run(SETTLE_S + NOW_S - 1.0)
    assert rig.ask(act="keep", why="3 dB less at 1x").text == rig.other()
    rig.running.control.deaf = True
    rig.run(2.0)
    said = rig.ask(act="keep", why="3 dB less at 1x").json
    assert not said["ok"]
    assert said["message"].startswith("the former settings return already (ripple of unwind_")
    rig.running.control.deaf = False
    rig.run(3.0)
    assert rig.runs_the_former
    assert rig.rows[-1][0] == "returned"


def test_who_saves_what_was_taken_back_meanwhile_has_edited_and_not_kept(rig):
    rig.begin(seconds=10.0)
    rig.ask(act="keep", why="3 dB less at 1x")
    rig.running.control.deaf = True
    rig.running.live = False
    rig.run(0.3)
    rig.site.write_text(rig.other())
    rig.run(0.3)
    assert rig.running.parameters.site_text == rig.other()  # not heard yet
    rig.running.control.deaf = False
    rig.run(4.0)
    verbs = [verb for verb, _ in rig.rows]
    assert verbs[-3:] == ["tried", "returned", "edited"]
