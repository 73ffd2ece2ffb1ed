"""The site file that follows: every place is filled, numbers are those of the PLC's manual."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.app.setup.asking.draft import Draft, FoundWord, read_draft, write_draft
from aff_runtime.app.setup.text.modbus_text import register_number
from aff_runtime.app.setup.text.site_text import site_text
from aff_runtime.config.loader import load_site
from tests.aff_runtime.config.shipped import EUCLID

ANSWERS = {
    "wire": "modbus_tcp", "host": "10.0.0.1", "port": "502", "device_id": "1", "first": "0",
    "count": "100", "heartbeat": "0", "scan_ms": "10", "number": "0", "name": 'Line "2" # äöü',
    "second": "none", "speed_max": "300 FPM", "tension_max": "90 lbf", "radius_min": "4 in",
    "radius_max": "12 in", "limit": "0.05", "probe": "0.0008", "function": "fc3_fc16",
    "law": "blocks", "status.word": "1", "status.order": "yes", "roll_id": "8", "echo": "none",
    "write": "100", "correction_scale": "0.00001",
}  # fmt: skip
WORDS = {
    "unwind_tension_N": FoundWord(address=2, type="i32", order="low_first", scale="0.01 lbf"),
    "line_speed_m_s": FoundWord(address=5, type="i16", order="", scale="-0.001"),
    "unwind_radius_m": FoundWord(address=6, type="u16", order="", scale="0.00002"),
}
DRAFT = Draft(answers=ANSWERS, words=WORDS)


def test_a_small_line_is_a_valid_site(tmp_path: Path) -> None:
    path = tmp_path / "line2.yaml"
    path.write_text(site_text(DRAFT, file="line2"), encoding="utf-8")
    site = load_site(path)
    assert site.line.name == ANSWERS["name"]
    assert site.gateway.word_order == "low_first"
    assert site.gateway.read.channels["unwind_tension_N"].scale == pytest.approx(0.0444822, 1e-5)
    assert site.gateway.read.channels["line_speed_m_s"].scale == -0.001
    assert site.freshness.hold_after_ms == 30  # three scans
    assert site.actuators["unwind"].response == "learned/line2_unwind.json"
    assert "@" not in path.read_text(encoding="utf-8")
    assert site.probe.duration_s == 25.0
    assert site.line.speed_reference is None
    assert "  #speed_reference: line_speed_ref_m_s\n" in path.read_text(encoding="utf-8")
    assert "For the record alone, under" not in path.read_text(encoding="utf-8")


def test_an_angle_whose_end_was_not_seen_says_so_and_for_how_long(tmp_path: Path) -> None:
    word = FoundWord(address=11, type="u16", order="", scale="4096 counts/turn", unseen_s=44.98)
    text = site_text(DRAFT.with_word("unwind_angle_rad", word), file="line2")
    at = text.splitlines().index(
        "      # Its end was not seen in 45 s of setup: take from the manual of"
    )
    assert text.splitlines()[at + 2].startswith("      unwind_angle_rad: { register")
    path = tmp_path / "line2.yaml"
    path.write_text(text)
    assert load_site(path).gateway.read.channels["unwind_angle_rad"].wraps


def test_a_count_that_starts_over_early_says_after_how_many_counts(tmp_path: Path) -> None:
    word = FoundWord(address=11, type="u16", order="", scale="3600 counts/turn", wraps_after=3600)
    path = tmp_path / "line2.yaml"
    path.write_text(site_text(DRAFT.with_word("unwind_angle_rad", word), file="line2"))
    channel = load_site(path).gateway.read.channels["unwind_angle_rad"]
    assert (channel.wraps, channel.wraps_after) == (True, 3600)


def test_a_further_channel_that_was_named_and_not_found_is_left_out(tmp_path: Path) -> None:
    named = DRAFT.with_answer("further.1", "r3_tension_N").with_answer(
        "further.2", "rewind_tension_N"
    )
    word = FoundWord(address=20, type="i32", order="low_first", scale="0.001")
    path = tmp_path / "line2.yaml"
    path.write_text(site_text(named.with_word("rewind_tension_N", word), file="line2"))
    assert set(load_site(path).gateway.read.channels) == {*WORDS, "rewind_tension_N"}
    assert "      # For the record alone, under the names of the line file" in path.read_text()


@pytest.mark.parametrize(
    ("told", "density"), [({}, 0.0), ({"density": "395", "width": "6 in", "core": "44 mm"}, 395.0)]
)
def test_a_drive_that_nobody_has_numbers_for_is_left_to_the_probe(
    told: dict[str, str], density: float, tmp_path: Path
) -> None:
    path = tmp_path / "line2.yaml"
    draft = Draft(
        answers={**ANSWERS, "law": "shape", "usual_tension": "20 lbf", **told}, words=WORDS
    )
    path.write_text(site_text(draft, file="line2"), encoding="utf-8")
    drive = load_site(path).actuators["unwind"].drive
    assert drive is not None
    assert (drive.speed_gain_rad_s, drive.zeta, drive.inertia_kg_m2) == (None, None, None)
    assert drive.web_density_kg_m3 == density
    assert drive.tension_N == pytest.approx(20 * 4.4482216)
    assert load_site(path).probe.duration_s == 60.0


def test_comments_stand_before_the_sections_as_in_the_shipped_file() -> None:
    text = site_text(DRAFT, file="line2")
    shipped = EUCLID.read_text(encoding="utf-8")
    sections = [line for line in shipped.splitlines() if line and line[0].islower()]
    assert [line for line in text.splitlines() if line and line[0].islower()] == sections
    own = {line.strip() for line in text.splitlines() if line.strip().startswith("# ")}
    theirs = {line.strip() for line in shipped.splitlines() if line.strip().startswith("# ")}
    assert len(own & theirs) > 0.8 * len(theirs)


@given(address=st.integers(0, 65534), style=st.sampled_from([0, 1, 40001, 400001]))
def test_a_manual_s_number_means_its_wire_address(address: int, style: int) -> None:
    numbered = DRAFT.with_answer("number", str(style))
    base = 1 if style else 0
    shown = register_number(numbered, address)
    # as the site file's reference says it
    back = shown - base
    if base and 40001 <= shown <= 49999:
        back = shown - 40001
    if base and 400001 <= shown <= 465536:
        back = shown - 400001
    assert back == address


def test_what_is_kept_comes_back_and_one_thing_can_be_asked_again(tmp_path: Path) -> None:
    path = tmp_path / "site.setup.json"
    write_draft(path, DRAFT)
    assert read_draft(path) == DRAFT
    assert "line_speed_m_s" not in DRAFT.without("line_speed_m_s").words
    assert read_draft(tmp_path / "none.json") == Draft()


@pytest.mark.parametrize(
    ("kept", "name"), [({}, ""), ({"second": "none"}, ""), ({"second": "lead"}, "lead")]
)
def test_a_second_roller_that_was_not_asked_for_yet_is_none(
    kept: dict[str, str], name: str
) -> None:
    assert Draft(answers=kept).second == name


def test_words_have_owners_and_an_order() -> None:
    assert DRAFT.order == "low_first"
    assert DRAFT.owners[3] == "unwind_tension_N"
    assert DRAFT.owners[8] == "roll_id"
    own = DRAFT.with_answer("bits.LINE_RUN", "20.7 inverted")
    assert own.owners[20] == "bits.LINE_RUN"
