"""Edits of the form as jobs: what reaches the service, and what is refused before."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from aff_runtime.app.commission import paths
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.settings import form_jobs as settings_form_jobs
from aff_runtime.app.commission.settings import jobs as settings_jobs
from aff_runtime.app.commission.settings.form_jobs import (
    difference,
    form,
    go_back,
    save_edited,
    try_edited,
    version,
)
from aff_runtime.app.link.settings_answer import SettingsAnswer, Version
from aff_runtime.base.errors import ConfigError, RefusedError, WireError
from aff_runtime.base.text_digest import text_digest
from tests.aff_runtime.app.commission.judged_site import judged_site
from tests.aff_runtime.app.commission.said import plain
from tests.aff_runtime.app.judged_here import judged_here

SETTLE = "actuators.unwind.blocks[0].settle_s"
CHANGED = {"ok": False, "why": "changed", "name": ""}


class Talk:
    def say(self, text):
        pass


class Service:
    """In place of the service: a history of texts, the last of which runs."""

    def __init__(self, *texts):
        self.texts = texts
        self.trying = self.waiting = ""
        self.changes = (f"{SETTLE}: 6 s -> 12 s (applies at once)",)
        self.asked = []
        self.refuses = self.refuses_diff = None
        self.saved_meanwhile = ""  # between two questions

    def __call__(self, where, **asked):
        if self.refuses is not None:
            raise self.refuses
        if asked["act"] not in ("history", "state"):
            self.asked.append(asked)
        state = SettingsAnswer(
            running=text_digest(self.texts[-1]),
            trying=self.trying,
            waiting=self.waiting,
            versions=self.versions,
        )
        if asked["act"] == "save":
            return replace(state, text=asked["text"], replaces="r")
        match asked["act"]:
            case "diff" if self.refuses_diff is not None:
                raise self.refuses_diff
            case "diff" if self.saved_meanwhile:
                return replace(state, running=text_digest(self.saved_meanwhile))
            case "diff":
                return replace(state, changes=self.changes)
            case "history" if asked.get("version"):
                return replace(state, text=self.texts[asked["version"] - 1])
            case "undo":
                return replace(state, text=self.texts[asked["version"] - 1], replaces="r")
            case _:
                return state

    @property
    def versions(self):
        return tuple(
            Version(number=n, when="u", who="w", verb="edited", why="", sha256=text_digest(text))
            for n, text in enumerate(self.texts, start=1)
        )


@pytest.fixture
def where(tmp_path, monkeypatch):
    return judged_site(tmp_path, monkeypatch, paths, settings_form_jobs)


@pytest.fixture
def text(where):
    return where.site.read_text(encoding="utf-8")


@pytest.fixture
def service(where, text, monkeypatch):
    found = Service(text.replace("settle_s: 6,", "settle_s: 20,", 1), text)
    for module in (settings_form_jobs, settings_jobs):
        monkeypatch.setattr(module, "ask_settings", found)
    return found


def asked(do, text, **more):
    wanted = text.replace("settle_s: 6,", "settle_s: 12,", 1)
    said = {
        "base": text_digest(text),
        "edits": f"{SETTLE}: 12",
        "measured": text_digest(wanted),
        **more,
    }
    return Request(do=do, seconds=60, reason="hunting at 1x", account="carl", **said)


def test_the_form_is_of_the_file_and_names_its_digest_and_the_newest_version_first(
    where, text, service
):
    view = form(where, Request(do="settings"), Talk()).settings
    assert (view.sha256, view.running, view.against) == (text_digest(text), text_digest(text), "")
    assert [one.number for one in view.versions] == [2, 1]
    (settle,) = [one for s in view.sections for one in s.settings if one.path == SETTLE]
    assert settle.written == "6"
    warned = judged_here(where.site, where.state).findings
    assert len(view.said) == len(warned) > 0
    assert all(one.path and one.text in w for one, w in zip(view.said, warned, strict=True))


def test_a_file_that_is_not_good_is_told_by_its_findings_and_can_be_edited_by_nobody(
    where, text, service
):
    where.site.write_text(text.replace("settle_s: 6,", "settle_s: 0.5,", 1))
    view = form(where, Request(do="settings"), Talk()).settings
    assert (view.sha256, view.sections) == ("", ())
    assert [one.path for one in view.said] == [SETTLE]
    assert "not what runs" in view.against


def test_without_a_service_the_file_is_shown_and_why_nothing_can_be_tried(where, text, service):
    service.refuses = WireError("no service answers")
    view = form(where, Request(do="settings"), Talk()).settings
    assert (view.against, view.versions) == ("no service answers", ())
    assert view.sections


def test_a_difference_is_of_the_whole_text_and_changes_nothing(where, text, service):
    found = difference(where, asked("settings_diff", text), Talk()).difference
    wanted = text.replace("settle_s: 6,", "settle_s: 12,", 1)
    assert service.asked == [{"act": "diff", "text": wanted}]
    assert (found.sha256, found.refused, found.waits) == (text_digest(wanted), False, False)
    assert sorted(line[0] for line in found.lines if line[0] in "+-") == ["+", "-"]
    assert where.site.read_text(encoding="utf-8") == text


def test_findings_of_the_check_stand_at_their_settings(where, text, service):
    service.refuses = ConfigError(f"{where.site}:60:40  {SETTLE}: 1 to 300 s is allowed")
    found = difference(where, asked("settings_diff", text), Talk()).difference
    assert (found.refused, found.changes) == (True, ())
    assert [(one.path, one.text) for one in found.said] == [(SETTLE, "1 to 300 s is allowed")]
    service.refuses = RefusedError("other settings are being checked; try again")
    with pytest.raises(RefusedError, match="try again"):
        difference(where, asked("settings_diff", text), Talk())


def test_a_try_says_on_what_it_was_decided_and_by_whom(where, text, service):
    try_edited(where, asked("try_settings", text), Talk())
    (sent,) = service.asked
    assert sent == {
        "act": "try",
        "text": text.replace("settle_s: 6,", "settle_s: 12,", 1),
        "seconds": 60.0,
        "why": "hunting at 1x (carl at the screen)",
        "base": text_digest(text),
    }


@pytest.mark.parametrize("job", [difference, try_edited])
def test_what_somebody_saved_since_the_form_was_seen_stands_against_it(where, text, service, job):
    said = asked("", text)
    where.site.write_text(text.replace("settle_s: 10,", "settle_s: 11,", 1))
    assert plain(job(where, said, Talk())) == CHANGED
    assert service.asked == []


def test_another_text_than_was_shown_is_not_tried(where, text, service):
    said = asked("try_settings", text, edits=f"{SETTLE}: 13")
    assert plain(try_edited(where, said, Talk())) == CHANGED
    assert service.asked == []


LIMIT = "line.cycle_ms"


def saving(text, **more):
    wanted = text.replace("cycle_ms: 5", "cycle_ms: 10", 1)
    said = {
        "base": text_digest(text),
        "edits": f"{LIMIT}: 10",
        "measured": text_digest(wanted),
        **more,
    }
    return Request(do="save_settings", reason="the PLC scans every 10 ms", account="carl", **said)


@pytest.mark.parametrize(
    ("runs", "told"),
    [(True, "saved as the site file, and runs"),
     (False, "what is saved takes effect at the next bypass")],
)  # fmt: skip
def test_what_waits_for_bypass_is_saved_with_who_and_why(
    where, text, service, monkeypatch, runs, told
):
    saved = []
    monkeypatch.setattr(
        settings_form_jobs, "save_handed_out", lambda w, a: saved.append(a.text) or runs
    )
    assert save_edited(where, saving(text), Talk()).text == told
    (sent,) = service.asked
    wanted = text.replace("cycle_ms: 5", "cycle_ms: 10", 1)
    assert sent == {
        "act": "save",
        "text": wanted,
        "why": "the PLC scans every 10 ms (carl at the screen)",
        "base": text_digest(text),
    }
    assert saved == [wanted]


@pytest.mark.parametrize("wrong", [{"base": "0" * 64}, {"measured": "0" * 64}])
def test_another_text_than_was_shown_is_not_saved(where, text, service, wrong):
    assert plain(save_edited(where, saving(text, **wrong), Talk())) == CHANGED
    assert service.asked == []


def test_a_saved_text_that_waits_is_told_and_can_be_taken_back(where, text, service):
    waiting = text.replace("cycle_ms: 5", "cycle_ms: 10", 1)
    where.site.write_text(waiting, encoding="utf-8")
    service.waiting = text_digest(waiting)
    view = form(where, Request(do="settings"), Talk()).settings
    assert view.against == "what is saved takes effect at the next bypass"
    running = version(where, Request(do="settings_version", number=2, back=True), Talk()).version
    assert running.against == ""
    assert [one for one in running.back.lines if one.startswith("-")] == ["-  cycle_ms: 10"]


def test_a_version_that_differs_in_a_comment_alone_can_be_gone_back_to(where, text, service):
    service.texts = (text + "# as in spring\n", text)
    service.changes = ()
    found = version(where, Request(do="settings_version", number=1, back=True), Talk()).version
    assert found.back.changes == ()
    assert [one for one in found.back.lines if one[0] in "+-"] == ["+# as in spring"]


def test_a_version_says_what_it_changed_and_what_going_back_would(where, text, service):
    found = version(where, Request(do="settings_version", number=1, back=True), Talk()).version
    assert found.lines == ()  # none ran before it
    assert found.back is not None
    assert found.back.sha256 == text_digest(service.texts[0])
    assert found.against == ""
    newest = version(where, Request(do="settings_version", number=2, back=True), Talk()).version
    assert [line for line in newest.lines if "settle_s: 20" in line and line[0] == "-"]
    assert (newest.back, newest.against) == (None, "this is what runs")
    service.trying = "settings 01 by carl"
    during = version(where, Request(do="settings_version", number=1, back=True), Talk()).version
    assert (during.back, during.against[:27]) == (None, "settings are being tried; k")
    with pytest.raises(RefusedError, match="no version 9"):
        version(where, Request(do="settings_version", number=9), Talk())


def test_who_may_not_go_back_has_the_service_check_nothing(where, text, service):
    found = version(where, Request(do="settings_version", number=1), Talk()).version
    assert (found.back, found.against[:32]) == (None, "this account may not change setti"[:32])
    assert service.asked == []


def test_going_back_saves_what_was_shown_and_nothing_else(where, text, service, monkeypatch):
    saved = []
    monkeypatch.setattr(
        settings_form_jobs, "save_handed_out", lambda w, a: saved.append(a.text) is None
    )
    old = service.texts[0]
    said = Request(
        do="go_back",
        number=1,
        base=text_digest(text),
        measured=text_digest(old),
        reason="as in spring",
        account="carl",
    )
    assert plain(go_back(where, replace(said, measured="0" * 64), Talk())) == CHANGED
    assert plain(go_back(where, replace(said, base="0" * 64), Talk())) == CHANGED
    assert saved == []
    assert "version 1 is saved" in go_back(where, said, Talk()).text
    assert saved == [old]
    service.trying = "settings 01 by carl"
    with pytest.raises(RefusedError, match="being tried"):
        go_back(where, said, Talk())


def test_a_version_that_the_check_refuses_by_now_is_not_gone_back_to(
    where, text, service, monkeypatch
):
    saved = []
    monkeypatch.setattr(
        settings_form_jobs, "save_handed_out", lambda w, a: saved.append(a.text) is None
    )
    service.refuses_diff = ConfigError(f"{where.site}:60:40  {SETTLE}: 1 to 300 s is allowed")
    old = service.texts[0]
    seen = {"base": text_digest(text), "measured": text_digest(old), "reason": "as in spring"}
    said = Request(do="go_back", number=1, account="carl", **seen)
    with pytest.raises(RefusedError, match=re.escape(f"{SETTLE}: 1 to 300 s is allowed")):
        go_back(where, said, Talk())
    assert saved == []
    assert [one["act"] for one in service.asked] == ["diff"]


def test_a_version_names_the_settings_that_its_difference_is_against(where, text, service):
    asked_for = Request(do="settings_version", number=1, back=True)
    assert version(where, asked_for, Talk()).version.running == text_digest(text)
    service.saved_meanwhile = text.replace("settle_s: 10,", "settle_s: 11,", 1)
    with pytest.raises(RefusedError, match="somebody has saved other settings"):
        version(where, asked_for, Talk())
