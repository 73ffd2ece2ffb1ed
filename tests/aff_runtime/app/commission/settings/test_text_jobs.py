"""The site file as a text: one with the form, checked as the check does, put onto another edit."""

from __future__ import annotations

import pytest
import yaml

from aff_runtime.app.commission import paths
from aff_runtime.app.commission.link.answers import DifferenceShown, TextShown
from aff_runtime.app.commission.link.messages import Refusal, Request, Why
from aff_runtime.app.commission.settings import form_jobs as settings_form_jobs
from aff_runtime.app.commission.settings import text_jobs as settings_text_jobs
from aff_runtime.app.commission.settings.form_jobs import difference, save_edited, try_edited
from aff_runtime.app.commission.settings.site_lines import Clash
from aff_runtime.app.link.settings_answer import SettingsAnswer
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.base.text_digest import text_digest
from tests.aff_runtime.app.commission.judged_site import judged_site
from tests.aff_runtime.app.judged_here import judged_here

SETTLE = "actuators.unwind.blocks[0].settle_s"
ADDED = "actuators.swrap_follower.blocks[1]"
BLOCK = (
    "      # heard at 200 FPM\n"
    "      - { roll: unwind, orders: [1], settle_s: 10, amp_limit_m_s: 0.01 }\n"
)
LAST = "      - { roll: swrap_follower, orders: [1], settle_s: 8, amp_limit_m_s: 0.03 }\n"
BOMB = "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"{new}: &{new} [{', '.join([f'*{old}'] * 10)}]\n"
    for old, new in zip("abcdefgh", "bcdefghi", strict=True)
)


class Talk:
    def say(self, text):
        raise AssertionError(text)


@pytest.fixture
def where(tmp_path, monkeypatch):
    return judged_site(tmp_path, monkeypatch, paths, settings_form_jobs, settings_text_jobs)


@pytest.fixture
def file(where):
    return where.site.read_text(encoding="utf-8")


@pytest.fixture
def asked_of_service(monkeypatch):
    """What the service is asked; it refuses what the check does."""
    found = []

    def service(where, **said):
        found.append(said)
        judged_here(where.site, where.state, said["text"])
        return SettingsAnswer(running="", changes=("a change (applies at once)",))

    monkeypatch.setattr(settings_form_jobs, "ask_settings", service)
    return found


def text(where, file, typed="", edits="", former="", base=""):
    said = {
        "base": base or text_digest(file),
        "site_text": typed,
        "edits": edits,
        "former": former,
    }
    answer = settings_text_jobs.text(where, Request(do="settings_text", **said), Talk())
    assert isinstance(answer, TextShown)
    return answer.edited


def looked(where, file, typed, edits=""):
    asked = Request(do="settings_diff", base=text_digest(file), site_text=typed, edits=edits)
    answer = difference(where, asked, Talk())
    assert isinstance(answer, DifferenceShown)
    return answer.difference


def setting(view, path):
    (found,) = [one for s in view.sections for one in s.settings if one.path == path]
    return found


def test_the_text_is_the_files_where_nothing_is_edited(where, file):
    view = text(where, file)
    assert (view.base, view.file, view.text, view.clashes) == (text_digest(file), file, file, ())
    assert setting(view, SETTLE).written == "6"


def test_what_the_form_edits_stands_in_the_text_with_every_comment(where, file):
    view = text(where, file, edits=f"{SETTLE}: 12")
    assert view.text == file.replace("settle_s: 6,", "settle_s: 12,", 1)
    assert setting(view, SETTLE).written == "12"
    assert view.file == file


def test_what_is_typed_stands_in_the_form_and_its_edits_go_on_top(where, file):
    typed = file.replace(LAST, LAST + BLOCK)
    view = text(where, file, typed)
    assert setting(view, f"{ADDED}.settle_s").written == "10"
    both = text(where, file, typed, edits=f"{ADDED}.settle_s: 20\n{SETTLE}: 12")
    wanted = typed.replace(BLOCK, BLOCK.replace("settle_s: 10", "settle_s: 20"))
    assert both.text == wanted.replace("settle_s: 6,", "settle_s: 12,", 1)
    assert "# heard at 200 FPM" in both.text
    blocks = yaml.safe_load(both.text)["actuators"]["swrap_follower"]["blocks"]
    assert [one["settle_s"] for one in blocks] == [8, 20]


def test_what_the_check_refuses_has_its_place_and_no_form(where, file):
    typed = file.replace("settle_s: 6,", "settle_s: 0.5,", 1)
    line = file[: file.index("settle_s: 6,")].count("\n") + 1
    view = text(where, file, typed)
    assert view.sections == ()
    (one,) = view.said
    assert (one.path, one.line) == (SETTLE, line)
    assert one.column == file.split("\n")[line - 1].index("settle_s: 6") + len("settle_s: ") + 1
    assert "1 to 300 s" in one.text


@pytest.mark.parametrize(
    ("typed", "line", "said"),
    [
        ("version: 1\n\tline: 2\n", 2, "a tab indents this line"),
        ("version: 1\nline: [1, 2\n", 3, "Check brackets"),
        ("version: 1\nname: a\x00b\n", 2, r"\x00 stands here"),
        ("version: 1\nname: a\ufeffb\n", 2, r"\ufeff stands here"),
        ("version: 1\rline: 2\n", 1, r"\r stands here"),
        ("version: 1\r\nline: 2\r\n", 1, r"\r stands here"),
        (BOMB, 1, "aliases unfold to too much"),
        ("a: " + "[" * 40 + "]" * 40, 1, "nests deeper than 20"),
        ("just words", 1, "must be a mapping"),
    ],
)
def test_hostile_text_is_refused_in_words_with_its_line(
    where, file, asked_of_service, typed, line, said
):
    for found in (text(where, file, typed), looked(where, file, typed)):
        assert said in found.said[0].text
        assert found.said[0].line == line
    assert looked(where, file, typed).refused
    assert looked(where, file, typed).changes == ()


def test_the_difference_is_of_what_was_typed_and_of_the_forms_edits_on_it(
    where, file, asked_of_service
):
    typed = file.replace(LAST, LAST + BLOCK)
    found = looked(where, file, typed)
    assert asked_of_service == [{"act": "diff", "text": typed}]
    assert found.sha256 == text_digest(typed)
    added = [one for one in found.lines if one[0] == "+"]
    assert added == [f"+{one}" for one in BLOCK.split("\n")[:-1]]
    twice = looked(where, file, typed, edits=f"{SETTLE}: 12")
    assert twice.sha256 == text_digest(typed.replace("settle_s: 6,", "settle_s: 12,", 1))


def test_line_ends_and_order_mark_of_the_file_stay(where, file, asked_of_service):
    windows = "\ufeff" + file.replace("\n", "\r\n")
    where.site.write_bytes(windows.encode("utf-8"))
    view = text(where, windows)
    assert view.text == file
    typed = file.replace(LAST, LAST + BLOCK)
    assert looked(where, windows, typed).sha256 == text_digest(
        "\ufeff" + typed.replace("\n", "\r\n")
    )


def test_what_is_tried_or_saved_is_the_text_that_was_shown(where, file, monkeypatch):
    sent = []

    def service(where, **said):
        sent.append(said)
        raise RefusedError("seen")

    for module in ("form_jobs", "jobs"):
        monkeypatch.setattr(f"aff_runtime.app.commission.settings.{module}.ask_settings", service)
    typed = file.replace(LAST, LAST + BLOCK)
    said = {
        "base": text_digest(file),
        "site_text": typed,
        "reason": "heard at 200 FPM",
        "seconds": 60,
    }
    for do in (try_edited, save_edited):
        asked = Request(do="x", measured=text_digest(typed), account="carl", **said)
        with pytest.raises(RefusedError, match="seen"):
            do(where, asked, Talk())
        assert sent.pop()["text"] == typed
        other = Request(do="x", measured="0" * 64, account="carl", **said)
        assert do(where, other, Talk()) == Refusal(why=Why.CHANGED)
        assert sent == []


def test_edits_on_a_text_that_is_not_good_are_told_by_its_findings(where, file, asked_of_service):
    found = looked(where, file, file.replace("settle_s: 6,", "settle_s: 0.5,", 1), f"{SETTLE}: 12")
    assert (found.refused, found.said[0].path, asked_of_service) == (True, SETTLE, [])
    with pytest.raises(ConfigError):
        text(where, file, "version: 1\n", edits=f"{SETTLE}: 12")


def test_another_persons_save_is_noticed_and_the_edit_can_be_put_onto_it(where, file):
    typed = file.replace(LAST, LAST + BLOCK)
    theirs = file.replace("cycle_ms: 5", "cycle_ms: 10", 1)
    where.site.write_text(theirs, encoding="utf-8")
    stale = Request(do="settings_text", base=text_digest(file), site_text=typed)
    assert settings_text_jobs.text(where, stale, Talk()) == Refusal(why=Why.CHANGED)
    assert difference(where, stale, Talk()) == Refusal(why=Why.CHANGED)
    view = text(where, theirs, typed, former=file)
    assert view.text == typed.replace("cycle_ms: 5", "cycle_ms: 10", 1)
    assert (view.file, view.clashes) == (theirs, ())
    mine = text(where, theirs, file.replace("cycle_ms: 5", "cycle_ms: 20", 1), former=file)
    line = file[: file.index("cycle_ms: 5")].count("\n") + 1
    assert mine.clashes == (Clash(line=line, theirs=("  cycle_ms: 10",)),)
    assert "cycle_ms: 20" in mine.text
