"""The site file as a form: every setting that there is, what is written, what may be edited."""

from __future__ import annotations

import pytest

from aff_runtime.app.commission.settings.form import (
    edits_in,
    lines_between,
    said_in,
    sections,
    text_with_edits,
)
from aff_runtime.app.commission.views.of_settings import SaidOfSetting
from aff_runtime.base.errors import AffError, RefusedError
from aff_runtime.config.loader import load_site, read_site
from tests.parameter_records import CONFIG

FILE = CONFIG / "euclid_blocks.yaml"
TEXT = FILE.read_text(encoding="utf-8")
SETTLE = "actuators.unwind.blocks[0].settle_s"


@pytest.fixture(scope="module")
def site():
    return load_site(FILE)


@pytest.fixture(scope="module")
def settings(site):
    return {one.path: one for section in sections(site, TEXT) for one in section.settings}


def test_a_setting_has_unit_bounds_default_and_what_is_written(settings) -> None:
    one = settings[SETTLE]
    assert (one.kind, one.unit, one.written, one.shown) == ("number", "s", "6", "6 s")
    assert (one.allowed, one.live, one.can_edit) == ("1 to 300 s", True, True)
    assert "Time in which the ripple settles" in one.help
    cycle = settings["line.cycle_ms"]
    assert (cycle.live, cycle.can_edit, cycle.unit) == (False, True, "ms")
    word = settings["gateway.word_order"]
    assert (word.kind, word.choices) == ("choice", ("high_first", "low_first"))
    orders = settings["actuators.unwind.blocks[0].orders"]
    assert orders.kind == "list"
    assert orders.written.startswith("[1")
    assert orders.can_edit


def test_what_is_left_to_its_default_is_shown_and_can_be_edited(settings) -> None:
    one = settings["actuators.unwind.blocks[0].enabled"]
    assert (one.kind, one.written, one.shown, one.default) == ("flag", "", "true", "true")
    assert (one.choices, one.live, one.can_edit) == (("true", "false"), True, True)


def test_no_two_settings_have_one_path_and_a_section_is_of_one_path(site) -> None:
    found = sections(site, TEXT)
    paths = [one.path for section in found for one in section.settings]
    assert len(set(paths)) == len(paths) > 150
    assert len({section.path for section in found}) == len(found) > 10
    for section in found:
        for one in section.settings:
            assert one.path == (f"{section.path}.{one.name}" if section.path else one.name)


def test_every_setting_that_can_be_edited_can_be_written_anew_as_it_stands(site, settings) -> None:
    editable = [one for one in settings.values() if one.can_edit]
    assert len(editable) > 10
    edits = "\n".join(f"{one.path}: {one.written}" for one in editable if one.written)
    assert text_with_edits(site, TEXT, edits) == TEXT


def test_a_section_that_is_not_there_is_not_edited_as_if_it_were_a_value(settings) -> None:
    drive = settings["actuators.unwind.drive"]
    assert (drive.written, drive.can_edit) == ("", False)


def test_an_edit_of_what_was_left_to_its_default_adds_its_line_alone(site) -> None:
    text = text_with_edits(site, TEXT, "probe.offset_Hz: 0.2\nrecording.segment_s: 30")
    gone = [one for one in text.split("\n") if one not in ("  offset_Hz: 0.2", "  segment_s: 30")]
    assert gone == TEXT.split("\n")
    above = text.split("\n")[text.split("\n").index("  offset_Hz: 0.2") - 1]
    assert above == "  #offset_Hz: 0.15"


def test_an_edit_changes_its_value_alone(site) -> None:
    text = text_with_edits(site, TEXT, f"{SETTLE}: 12\nactuators.unwind.soft_start_s: 5 s")
    changed = [(a, b) for a, b in zip(TEXT.split("\n"), text.split("\n"), strict=True) if a != b]
    assert len(changed) == 2
    assert all(a.partition("#")[2] == b.partition("#")[2] for a, b in changed)


@pytest.mark.parametrize(
    ("lines", "why"),
    [
        ("", "nothing is to be changed"),
        ("settle_s", "a line PATH: VALUE"),
        (f"{SETTLE}: 1\n{SETTLE}: 2", "a line PATH: VALUE"),
        ("actuators.unwind.no_such: 1", "no such setting"),
        ("actuators.unwind.drive: 10", "stands there as no single value"),
        ("probe.offset_Hz: 1, bound_N: 2", "one value"),
        (f"{SETTLE}: 1, amp_limit_m_s: 9", "one value"),
    ],
)
def test_what_cannot_be_edited_says_why(site, lines, why) -> None:
    with pytest.raises(AffError, match=why):
        text_with_edits(site, TEXT, lines)


def test_lines_are_edits() -> None:
    assert edits_in("a.b[0]: 1\nc: x y ") == {"a.b[0]": "1", "c": "x y"}
    with pytest.raises(RefusedError):
        edits_in("a.b[0]:1")


def test_findings_are_told_by_their_setting() -> None:
    found = said_in(
        [
            f"/etc/a site.yaml:12:3  {SETTLE}: read 0.5 s, 1 to 300 s is allowed",
            "/etc/site.yaml:1:1  the check was ended by SIGKILL. Somebody did that",
            "nothing of a file",
        ]
    )
    assert found == (
        SaidOfSetting(path=SETTLE, text="read 0.5 s, 1 to 300 s is allowed", line=12, column=3),
        SaidOfSetting(
            path="", text="the check was ended by SIGKILL. Somebody did that", line=1, column=1
        ),
        SaidOfSetting(path="", text="nothing of a file"),
    )


def test_a_character_that_turns_others_around_is_shown_as_what_it_is() -> None:
    found = lines_between("a: 1\n", "a: 1\nb: 2 # \u202e3 :b\x1b[2J\n")
    assert found[-1] == "+b: 2 # \\u202e3 :b\\x1b[2J"
    assert all(line.isprintable() for line in found)


def test_settings_of_a_block_say_of_which_roll_they_are(site) -> None:
    rolls = {one.path: one.roll for one in sections(site, TEXT)}
    blocks = [block.roll for block in site.actuators["unwind"].blocks]
    assert len(set(blocks)) > 1
    for number, roll in enumerate(blocks):
        assert rolls[f"actuators.unwind.blocks[{number}]"] == roll
    assert {rolls[path] for path in ("line", "actuators.unwind", "gateway")} == {""}


def test_a_roll_whose_name_says_nothing_is_told_in_the_form_which_way_it_winds(tmp_path) -> None:
    head, tail = TEXT.split("\nrolls:\n")
    rolls = tail.replace("  unwind:\n", "  aufwickler:\n", 1).replace(
        "roll: unwind", "roll: aufwickler"
    )
    path = tmp_path / FILE.name
    path.write_text(f"{head}\nrolls:\n{rolls}", encoding="utf-8")
    reading, text = read_site(path), path.read_text(encoding="utf-8")
    assert "Write winding" in {one.path: one.text for one in reading.warnings}["rolls.aufwickler"]
    found = {one.path: one for part in sections(reading.site, text) for one in part.settings}
    one = found["rolls.aufwickler.winding"]
    assert (one.kind, one.choices, one.can_edit) == ("choice", ("unwind", "rewind"), True)
    path.write_text(text_with_edits(reading.site, text, f"{one.path}: rewind"), encoding="utf-8")
    told = read_site(path)
    assert told.site.rolls["aufwickler"].winding == "rewind"
    assert "rolls.aufwickler" not in {one.path for one in told.warnings}
