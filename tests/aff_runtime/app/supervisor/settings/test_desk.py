"""Try, keep, undo: the former settings return unless the site file says otherwise."""

from __future__ import annotations

import errno

import pytest

from aff_runtime.app.link.replies import Reply
from aff_runtime.app.report.status_answer import NOT_SAID
from aff_runtime.app.supervisor import edit_session
from aff_runtime.app.supervisor.settings import desk as desk_module
from aff_runtime.app.supervisor.settings import history
from aff_runtime.base.text_digest import text_digest
from tests.aff_runtime.app.supervisor.settings.rig import WHO, AtOnce, Rig

LINE = "actuators.unwind.blocks[0].settle_s: 6 s -> 12 s (applies at once)"
ROLL = ("rolls:\n", "rolls:\n  r5: { radius_m: 0.0381 } # idler\n")
LAST = "      - { roll: swrap_follower, orders: [1], settle_s: 10, amp_limit_m_s: 0.01 }\n"
BLOCK = "      - { roll: r5, orders: [1], settle_s: 8, amp_limit_m_s: 0.02 }\n"


@pytest.fixture
def rig(tmp_path, monkeypatch):
    for module in (desk_module, edit_session):
        monkeypatch.setattr(module, "Validation", AtOnce)
    return Rig(tmp_path)


def test_a_diff_tells_every_change_with_its_unit_and_changes_nothing(rig):
    said = rig.ask(act="diff", text=rig.other())
    rig.run(0.2)
    assert said.json["changes"] == (LINE,)
    assert rig.running.control.taken == []
    wrong = rig.ask(act="diff", text=rig.other("cycle_ms: 5", "cycle_ms: 0"))
    rig.run(0.2)
    assert wrong.json["ok"] is False
    assert wrong.json["exit_code"] == 2
    assert f"{rig.site}:" in wrong.json["message"]


def test_a_diff_warns_of_what_is_new_and_not_of_what_was_there(rig):
    assert rig.edits.findings  # the shipped file has warnings of its own
    said = rig.ask(act="diff", text=rig.other())
    rig.run(0.2)
    assert said.json["remarks"] == ()
    more = rig.ask(act="diff", text=rig.other(*ROLL))
    rig.run(0.2)
    (remark,) = more.json["remarks"]
    assert "rolls.r5: no block uses this roll" in remark


def test_when_the_time_is_up_the_former_settings_return(rig):
    said = rig.begin(seconds=20.0)
    assert said.json["changes"] == (LINE,)
    assert rig.running.parameters.site_text == rig.other()
    assert rig.desk.trying.startswith(f"settings {text_digest(rig.other())[:12]} by ")
    assert rig.desk.trying_left_s == pytest.approx(20.0, abs=0.5)
    rig.run(19.0)
    assert rig.desk.trying_left_s == pytest.approx(1.0, abs=0.5)
    assert rig.running.parameters.site_text == rig.other()
    rig.run(1.5)
    assert rig.runs_the_former
    assert (rig.desk.trying, rig.desk.trying_left_s) == ("", NOT_SAID)
    assert rig.rows[-2:] == [("tried", "20 s: hunting at 1x"), ("returned", "its time is up")]
    assert rig.site.read_text() == rig.former


def test_a_whole_block_and_its_roll_go_in_and_come_out_again(rig):
    text = rig.other(*ROLL).replace(LAST, LAST + BLOCK)
    rig.begin(text, seconds=10.0)
    assert "r5" in rig.running.parameters.site.rolls
    rig.run(11.0)
    assert rig.runs_the_former


@pytest.mark.parametrize(("amplitude_N", "returns"), [(0.8, False), (1.1, False), (2.0, True)])
def test_the_former_settings_return_when_ripple_rises(rig, amplitude_N, returns):
    rig.run(21.0)
    rig.begin()
    rig.running.ring.signals.amplitude_N = amplitude_N
    rig.run(12.0)
    assert rig.runs_the_former is returns
    if returns:
        assert rig.rows[-1][1].startswith("ripple of unwind_tension_N rose from 0.7")


def test_a_second_try_right_after_a_bad_one_is_watched_as_well(rig):
    rig.run(21.0)
    rig.begin()
    rig.running.ring.signals.amplitude_N = 4.0
    rig.run(5.0)
    rig.ask(act="undo", why="it shakes")
    rig.running.ring.signals.amplitude_N = 1.0
    rig.run(1.0)
    rig.begin()
    rig.running.ring.signals.amplitude_N = 2.0
    rig.run(12.0)
    assert rig.runs_the_former
    assert rig.rows[-1][1].startswith("ripple of unwind_tension_N rose from 0.7")


def test_a_full_disk_takes_no_way_back_away(rig, monkeypatch, caplog):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(history, "replace_text", full)
    rig.begin(seconds=5.0)
    rig.run(6.0)
    assert rig.runs_the_former
    assert rig.rows[-1] == ("returned", "its time is up")
    assert "the settings' history is not kept" in caplog.text
    monkeypatch.setattr(desk_module, "Validation", full)
    assert rig.begin().json["message"].startswith("cannot be checked now: No space left")
    assert rig.runs_the_former


def test_a_site_file_that_is_gone_in_a_try_keeps_nothing_and_the_former_return(rig):
    rig.begin(seconds=10.0)
    rig.site.unlink()
    said = rig.ask(act="keep", why="3 dB less at 1x")
    assert "is not what runs" in said.json["message"]
    rig.run(1.0)
    assert rig.running.parameters.site_text == rig.former
    assert rig.rows[-1] == ("returned", "a file was saved meanwhile")


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("\n    limit_m_s: 0.05", "\n    limit_m_s: .nan"),
        ("\n    limit_m_s: 0.05", "\n    limit_m_s: .inf"),
        ("\n    limit_m_s: 0.05", "\n    limit_m_s: -0.05"),
        ("\n    limit_m_s: 0.05", f"\n    limit_m_s: 1{'0' * 400}"),
        ("settle_s: 6,", "settle_s: 1e-300,"),
        ("settle_s: 6,", "settle_s: !!python/object/apply:os.system [id],"),
        ("amplitude_m_s: 0.008", "amplitude_m_s: 5"),
        ("version: 1\n", "version: 1\n\0"),
        ("version: 1\n", f"version: 1\nx: {'[' * 20_000}\n"),
    ],
)
def test_a_hostile_value_is_refused_and_never_handed_over(rig, before, after):
    said = rig.begin(rig.other(before, after))
    assert said.json["ok"] is False
    assert said.json["exit_code"] == 2
    assert rig.running.control.taken == []
    assert rig.desk.trying == ""
    assert rig.begin().json["ok"] is True  # the desk goes on


def test_a_correction_that_is_taken_back_ends_a_try(rig):
    rig.begin()
    rig.running.live = False
    rig.run(0.3)
    assert rig.runs_the_former
    assert rig.rows[-1] == ("returned", "the correction was taken back")


def test_it_is_kept_once_the_file_says_it_and_with_who_and_why(rig):
    rig.begin(seconds=10.0)
    said = rig.ask(act="keep", why="3 dB less at 1x")
    assert said.text == rig.other()
    assert rig.rows[-1][0] == "tried"  # nobody has saved it
    rig.site.write_text(said.text)
    rig.run(0.4)
    assert rig.desk.trying == ""
    row = rig.ask(act="history").json["versions"][-1]
    assert (row["verb"], row["who"], row["why"]) == ("kept", WHO, "3 dB less at 1x")
    rig.run(60.0)
    assert rig.running.parameters.site_text == rig.other()
    assert rig.edits.differs == ()
    assert any("kept by uid 1000 (tech1 via root), pid 4711" in note for note in rig.running.notes)


def test_a_keep_that_nobody_saves_is_none(rig):
    rig.begin(seconds=10.0)
    rig.ask(act="keep", why="3 dB less at 1x")
    rig.run(25.0)
    assert rig.runs_the_former
    assert rig.rows[-1] == ("returned", "its time is up")


def test_a_keep_that_is_saved_too_late_is_an_edit_of_its_own(rig):
    rig.begin(seconds=300.0)
    said = rig.ask(act="keep", why="3 dB less at 1x")
    rig.run(40.0)
    rig.site.write_text(said.text)
    rig.run(1.0)
    assert ("returned", "a file was saved meanwhile") in rig.rows
    assert rig.rows[-1] == ("edited", "")
    assert rig.running.parameters.site_text == rig.other()


def test_a_try_saved_without_keep_is_an_edit_of_its_own(rig):
    rig.begin()
    rig.site.write_text(rig.other())
    rig.run(1.0)
    assert ("returned", "a file was saved meanwhile") in rig.rows
    assert rig.rows[-1][0] == "edited"
    assert rig.running.parameters.site_text == rig.other()


def test_another_edit_in_a_try_is_judged_after_the_return(rig):
    rig.begin()
    edited = rig.other("orders: [1, 2, 3, 4]", "orders: [1, 2]")
    rig.site.write_text(edited)
    rig.run(1.0)
    assert rig.running.parameters.site_text == edited
    assert [verb for verb, _ in rig.rows][-3:] == ["tried", "returned", "edited"]


def test_undo_ends_a_try_and_without_one_goes_back_to_what_stood_before(rig):
    rig.begin()
    said = rig.ask(act="undo", why="web flutters")
    rig.run(0.3)
    assert said.json["ok"] is True
    assert said.text == ""
    assert rig.runs_the_former
    assert rig.rows[-1] == ("returned", f"undone by {WHO}: web flutters")
    rig.begin()
    kept = rig.ask(act="keep", why="3 dB less at 1x")
    rig.site.write_text(kept.text)
    rig.run(1.0)
    back = rig.ask(act="undo", why="noise grew at night")
    assert back.text == rig.former
    rig.site.write_text(back.text)
    rig.run(1.0)
    assert rig.runs_the_former
    assert rig.rows[-1] == ("undone", "noise grew at night (version 1)")


def test_a_version_is_not_gone_back_to_while_a_try_runs(rig):
    rig.begin()
    said = rig.ask(act="undo", version=1, why="web flutters")
    assert said.json["message"] == "a try runs: end it first, by `undo` without a version"
    assert not rig.runs_the_former
    rig.ask(act="undo", why="web flutters")
    rig.run(0.3)
    assert rig.runs_the_former


def test_who_asked_for_undo_is_answered_where_the_hand_over_itself_fails(rig):
    rig.running.control.deaf = True
    rig.ask(act="try", text=rig.other(), seconds=60.0, why="hunting at 1x")
    rig.run(0.2)
    undone = rig.ask(act="undo", why="wrong file")
    rig.pending.refuse_all("the control process died; see the log")
    assert undone.json["ok"] is True


def test_a_control_process_that_dies_starts_on_the_former_settings(rig):
    rig.begin()
    rig.running.control = None
    rig.pending.refuse_all("the control process died; see the log")
    rig.desk.control_died()
    assert rig.running.parameters.site_text == rig.former
    assert rig.rows[-1] == ("returned", "the control process died")


def test_a_control_process_that_does_not_answer_is_started_anew_on_the_former_settings(rig):
    rig.begin(seconds=5.0)
    rig.running.control.deaf = True
    rig.run(20.0)
    assert rig.running.starts == [rig.former]
    assert rig.rows[-1] == ("returned", "its time is up; the control process was started anew")


def test_settings_that_the_control_process_refuses_are_not_tried(rig):
    rig.running.control.no = "a probe is under way; save the file after it"
    said = rig.begin()
    assert said.json["message"] == "a probe is under way; save the file after it"
    assert rig.running.parameters.site_text == rig.former
    assert rig.desk.trying == ""
    assert rig.rows == [("started", "")]
    rig.running.control.no = ""
    assert rig.begin().json["ok"] is True


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (("fade_ms: 150", "fade_ms: 100"), "freshness.fade_ms: 150 ms -> 100 ms (waits for"),
        (("# nothing here", "# nothing here"), "nothing differs from what runs"),
        (("cycle_ms: 5", "cycle_ms: 0"), "line.cycle_ms"),
    ],
)
def test_what_cannot_be_tried_is_refused_in_words(rig, edit, said):
    text = rig.other(*edit) if edit[0] in rig.former else rig.former
    asked = rig.begin(text)
    assert asked.json["ok"] is False
    assert said in asked.json["message"]
    assert rig.running.control.taken == []


def test_one_try_at_a_time_and_none_on_a_file_that_is_not_what_runs(rig):
    rig.begin()
    assert "keep or undo them first" in rig.begin().json["message"]
    rig.ask(act="undo", why="enough seen")
    rig.run(0.3)
    rig.site.write_text(rig.former + "# saved a moment ago\n")
    assert "is not what runs" in rig.begin().json["message"]


def test_without_a_try_there_is_nothing_to_keep_and_nothing_before_the_first(rig):
    assert rig.ask(act="keep", why="no such thing").json["message"].startswith("no settings are")
    assert rig.ask(act="undo", why="no such thing").json["message"].startswith("no version before")
    refused = rig.ask(act="undo", why="no such thing", version=9).json["message"]
    assert refused.startswith("no version 9: there is 1 alone; `aff-runtime settings history`")


def test_the_text_of_a_version_can_be_read(rig):
    said = rig.ask(act="history", version=1)
    assert said.text == rig.former
    assert [row["number"] for row in said.json["versions"]] == [1]


def test_a_service_that_stops_in_a_try_says_that_the_former_return(rig):
    rig.begin()
    rig.desk.close()
    assert rig.rows[-1] == ("returned", "the service stops")
    assert rig.site.read_text() == rig.former


def test_a_try_that_is_taken_while_the_service_stops_has_not_been(rig):
    rig.running.control.deaf = True
    said = rig.begin()
    rig.desk.close()
    rig.pending.resolve(Reply(id=1, ok=True))
    assert said.json["ok"] is False
    assert said.json["message"] == "the service stops"
    assert rig.rows[-1] == ("returned", "the service stops")
    assert "tried" not in {verb for verb, _ in rig.rows}


def test_a_warning_is_new_until_it_is_kept_and_old_from_then_on(rig):
    text = rig.other(*ROLL)
    rig.begin(text)
    said = rig.ask(act="keep", why="the idler comes next")
    rig.site.write_text(said.text)
    rig.run(0.5)
    assert rig.running.parameters.site_text == text
    same = rig.ask(act="diff", text=text + "# a comment\n")
    rig.run(0.2)
    assert (same.json["changes"], same.json["remarks"]) == ((), ())


def test_a_warning_of_a_file_that_was_saved_by_hand_is_not_new_either(rig):
    text = rig.other(*ROLL)
    rig.site.write_text(text)
    rig.run(0.5)
    assert rig.running.parameters.site_text == text
    same = rig.ask(act="diff", text=text)
    rig.run(0.2)
    assert same.json["remarks"] == ()
    rig.site.write_text(rig.former)
    rig.run(0.5)
    again = rig.ask(act="diff", text=text)
    rig.run(0.2)
    assert "rolls.r5: no block uses this roll" in again.json["remarks"][0]


def test_a_warning_of_what_was_only_tried_stays_new(rig):
    rig.begin(rig.other(*ROLL), seconds=5.0)
    rig.run(6.0)
    assert rig.runs_the_former
    again = rig.ask(act="diff", text=rig.other(*ROLL))
    rig.run(0.2)
    assert len(again.json["remarks"]) == 1
