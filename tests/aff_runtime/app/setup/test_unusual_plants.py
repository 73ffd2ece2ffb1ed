"""Setup on unusual plants, in virtual time: a site file that says what the PLC's map says."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import pytest

from aff_runtime.app.setup.asking.dialogue import Dialogue
from aff_runtime.app.setup.asking.draft import Draft, FoundWord, read_draft
from aff_runtime.app.setup.asking.interview import (
    further_question,
    second_question,
    second_tension,
)
from aff_runtime.app.setup.asking.questions import AnswerError
from aff_runtime.app.setup.flow import interview
from aff_runtime.base.signals import Command, Outcome
from aff_runtime.cli.main import main
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Site
from sim_plant.demo.unusual_plants import with_channels
from sim_plant.refine.records.run_site import run_site
from sim_plant.servers.plc_map import PlcMap
from tests.aff_runtime.cli.virtual_line import REWIND_M, SECOND_N, SPEED_M_S, VirtualLine
from tests.each_case import each_case
from tests.lockstep.plants import (
    PLANTS,
    SECOND,
    SECOND_CHANNEL,
    RefusedAnswerError,
    Stand,
    Technician,
    UnusualPlant,
)

BY_WORDS = [name for name, plant in PLANTS.items() if not plant.line]
NAMES = {SECOND_CHANNEL: f"{SECOND}_tension_N"}


MORE_WORDS = "more words"


def stand(plant: UnusualPlant, folder: Path) -> Stand:
    return Stand(plant, VirtualLine(0.005), folder)


Done = tuple[Stand, Technician, Path]


@pytest.fixture(scope="module")
def commissioned(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Done]:
    """Commission a plant once for all tests that only look at it and its folder."""

    @cache
    def of(name: str) -> Done:
        folder = tmp_path_factory.mktemp("commissioned")
        made = stand(more_words() if name == MORE_WORDS else PLANTS[name], folder)
        return made, made.commission(folder / "site.yaml"), folder

    return of


def assert_says_what_the_map_says(
    site: Site, plc: PlcMap, names: Mapping[str, str] = NAMES
) -> None:
    """Every word of the site file is the PLC's own, and reads what the PLC means."""
    read, base = site.gateway.read, site.gateway.address_base

    def at(number: int | None) -> int:
        assert number is not None
        return number - (40001 if base and number >= 40001 else base)

    assert site.gateway.word_order == ("low_first" if plc.low_first else "high_first")
    for name in ("plc_heartbeat", "status", "roll_id", "aff_echo"):
        assert at(getattr(read, name).register_number) == plc.read[name], name
    bits = read.status.bits.given if read.status.bits else {}
    said = {(name, one.register_number, one.bit, one.inverted) for name, one in bits.items()}
    shown = {
        (str(one.flag.name), None if one.address == plc.read["status"] else one.address, one.bit,
         one.inverted) for one in plc.status_bits
    }  # fmt: skip
    assert said == shown
    for name in ("aff_heartbeat", "state", "echo", "alarm", "limit", "config_revision"):
        assert at(getattr(site.gateway.write, name).register_number) == plc.write[name], name
    for row in plc.corrections:
        found = site.gateway.write.corrections[row.item.name]
        assert at(found.register_number) == row.item.address
        assert found.scale == pytest.approx(row.item.scale)
    for item in plc.channels:
        channel = read.channels[names.get(item.name, item.name)]
        said = (at(channel.register_number), channel.wraps)
        assert said == (item.address, item.wraps), item.name
        assert channel.scale == pytest.approx(item.scale, rel=1e-9), item.name
        assert channel.type[1:] == item.type[1:], item.name  # a sign that never shows is no error


@pytest.mark.parametrize("name", BY_WORDS)
@pytest.mark.sweep(every=12)
def test_setup_finds_the_words_of_an_unusual_plant_and_its_file_is_checked(
    name: str, commissioned: Callable[[str], Done], capsys: pytest.CaptureFixture[str]
) -> None:
    made, technician, folder = commissioned(name)
    site = load_site(folder / "site.yaml")
    assert_says_what_the_map_says(site, made.map)
    assert main(["check", str(folder / "site.yaml"), "--state-dir", str(folder)]) == 0
    capsys.readouterr()
    angles = [item.name for item in made.map.channels if item.wraps]
    assert technician.unasked == [f"{name}.pick" for name in angles]
    assert made.plant.registers.writes == 0
    scan_ms = 1e3 * made.map.scan_s or 5.0
    assert site.cycle_s == pytest.approx(1e-3 * scan_ms)
    assert site.freshness.hold_after_ms == pytest.approx(3.0 * scan_ms)


def test_a_plc_that_shows_nothing_of_a_turn_leaves_the_angle_out(tmp_path: Path) -> None:
    skipped = {f"{roll}_angle_rad.display": "skip" for roll in ("unwind", SECOND)}
    made = stand(UnusualPlant(answers=skipped), tmp_path)
    assert made.commission(tmp_path / "site.yaml").unasked == []
    rolls = load_site(tmp_path / "site.yaml").rolls
    assert rolls["unwind"].angle is None
    assert rolls[SECOND].speed == f"{SECOND}_speed_m_s"


REFERENCE = {"line_speed_ref_m_s": "{ address: 18, type: i16, scale: 0.001 }"}
FURTHER = {
    "r3_tension_N": "{ address: 19, type: i32, scale: 0.001 }",
    "rewind_speed_rad_s": "{ address: 21, type: i16, scale: -0.01 }",
}
RPM = 60.0 / 6.283185307179586


def more_words(**answers: str) -> UnusualPlant:
    """Return a plant whose PLC shows the set point of the speed and two words for the record."""
    shown = {
        "second.tension": SECOND_CHANNEL,
        f"{SECOND_CHANNEL}.display": f"{SECOND_N:.0f} N",
        "line_speed_ref_m_s.display": "6.000 m/s",
        "line_speed_ref_m_s.pick": "w18",
        "further.1": "r3_tension_N",
        "r3_tension_N.display": "83 N",
        "further.2": "rewind_speed_rad_s",
        "rewind_speed_rad_s.display": f"{-SPEED_M_S / REWIND_M * RPM:.1f} rpm",
    }
    return UnusualPlant(
        plc=(with_channels({**REFERENCE, **FURTHER}),), answers={**shown, **answers}
    )


def test_the_set_point_of_the_speed_and_further_words_are_found_and_mapped(
    commissioned: Callable[[str], Done],
) -> None:
    made, _, folder = commissioned(MORE_WORDS)
    site = load_site(folder / "site.yaml")
    assert_says_what_the_map_says(site, made.map, {})
    assert site.line.speed_reference == "line_speed_ref_m_s"
    assert site.actuators[SECOND].error.signal == SECOND_CHANNEL
    assert list(site.gateway.read.channels)[-2:] == list(FURTHER)
    assert site.recorded_only >= {"line_speed_ref_m_s", *FURTHER}
    read_by_refine = run_site((folder / "site.yaml").read_text(), "site.yaml")
    assert read_by_refine.speed_reference == "line_speed_ref_m_s"
    assert read_by_refine.count_sizes["rewind_speed_rad_s"] == pytest.approx(0.01)


def test_of_three_words_with_one_speed_the_set_point_is_the_one_that_stands_still(
    tmp_path: Path,
) -> None:
    """Words 5 and 7 show the same value and are noisy; 18 takes the first row."""
    first = {"line_speed_ref_m_s.pick": "1", "r3_tension_N.pick": "1"}
    made = stand(more_words(**first), tmp_path)
    made.commission(tmp_path / "site.yaml")
    assert_says_what_the_map_says(load_site(tmp_path / "site.yaml"), made.map, {})


@each_case(
    ("name", "why"),
    [
        (
            "r3_tension",
            "r3_tension does not end with its SI unit. Let it end with one of: _rad_s ",
        ),
        (
            "rewind_angle_rad",
            "rewind_angle_rad is an angle: setup finds the encoders of corrected",
        ),
        ("unwind_tension_N", "unwind_tension_N is asked for already. Write another name."),
        ("R3 tension", '"R3 tension" is no name. Begin with a small letter'),
    ],
)
def test_a_name_that_no_further_channel_can_have_is_refused_with_what_to_do(
    name: str, why: str
) -> None:
    read = further_question(Draft(answers={"second": SECOND}), 1).read
    with pytest.raises(AnswerError) as refused:
        read(name)
    assert str(refused.value).startswith(why)


def test_a_list_that_ends_earlier_the_second_time_leaves_nothing_of_the_first(
    tmp_path: Path, commissioned: Callable[[str], Done]
) -> None:
    path = tmp_path / "site.setup.json"
    shutil.copy(commissioned(MORE_WORDS)[2] / path.name, path)
    kept = read_draft(path)
    assert kept.further == tuple(FURTHER)
    one_less = kept.without("further.2")  # as `--again further.2`
    assert one_less.words.keys() == kept.words.keys() - {"rewind_speed_rad_s"}
    made = stand(more_words(**{"further.1": "none"}), tmp_path)
    dialogue = Dialogue(kept.without("further.1"), path, Technician(made))
    interview(dialogue, made.reader)
    assert dialogue.draft.further == ()
    assert dialogue.draft.words.keys() == kept.words.keys() - FURTHER.keys()


def test_the_word_of_the_second_tension_is_forgotten_with_its_name() -> None:
    draft = Draft(answers={"second": SECOND, "second.tension": SECOND_CHANNEL})
    word = FoundWord(address=9, type="i32", order="high_first", scale="0.001")
    known = draft.with_word(SECOND_CHANNEL, word)
    for name in ("second", "second.tension", SECOND_CHANNEL):
        assert not known.without(name).words, name
    assert second_tension(known.without("second.tension")) == f"{SECOND}_tension_N"
    with pytest.raises(
        AnswerError, match=r"pull_roll_speed_m_s is in m/s\. Name a channel in N\."
    ):
        second_question(SECOND).read("pull_roll_speed_m_s")


EXPECTED = "expected a force: a number in N, or with its unit (mN, kN, lbf)."
DANCER = (
    "Where a dancer stands is no tension: AFF takes ripple out of a tension that is measured. "
    "Type what a load cell between the unwind and the next driven roller shows; a line without "
    "one has nothing that AFF could listen to."
)
TORQUE = (
    "output: setup writes site files for a speed reference alone, and a probe finds a drive only "
    "behind one. Let the PLC add the correction to the speed reference behind its ramp; or copy "
    "config/euclid_blocks.yaml, write output: torque_reference there, and limits and correction "
    "in N m (docs/config-reference.md)."
)


@pytest.mark.parametrize(
    ("shown", "why"),
    [
        ("12.4 mm", '"12.4 mm" is a length'),
        ("48 %", '"48 %" is a ratio'),
        ("3.5 deg", '"3.5 deg" is an angle'),
    ],
)
def test_a_dancer_instead_of_a_load_cell_is_told_why_not(
    shown: str, why: str, tmp_path: Path
) -> None:
    made = stand(UnusualPlant(answers={"unwind_tension_N.display": shown}), tmp_path)
    with pytest.raises(RefusedAnswerError) as refused:
        made.commission(tmp_path / "site.yaml")
    assert str(refused.value) == f"unwind_tension_N.display: {why}, {EXPECTED} {DANCER}"
    assert not (tmp_path / "site.yaml").exists()


def test_a_torque_reference_is_told_why_not_and_what_to_do(tmp_path: Path) -> None:
    made = stand(UnusualPlant(answers={"output": "torque"}), tmp_path)
    with pytest.raises(RefusedAnswerError) as refused:
        made.commission(tmp_path / "site.yaml")
    assert str(refused.value) == TORQUE
    assert not (tmp_path / "site.yaml").exists()


def test_two_lines_on_one_gateway_have_a_site_file_each(
    tmp_path: Path, commissioned: Callable[[str], Done]
) -> None:
    one = stand(UnusualPlant(), tmp_path)
    one.commission(tmp_path / "site.yaml")
    other, _, folder = commissioned("low words first")
    sites = [load_site(at / "site.yaml") for at in (tmp_path, folder)]
    for at, made, site in zip((tmp_path, folder), (one, other), sites, strict=True):
        assert main(["check", str(at / "site.yaml"), "--state-dir", str(at)]) == 0
        assert_says_what_the_map_says(site, made.map)
    assert [site.gateway.word_order for site in sites] == ["high_first", "low_first"]


@pytest.mark.parametrize(
    ("answers", "troubles"),
    [
        ({"function": "fc3_fc16"}, ()),
        ({}, ("the PLC does not know function 23 (exception 1): write function: fc3_fc16 into the "
              "site file",)),
    ],
)  # fmt: skip
@pytest.mark.sweep(every=2)
def test_a_plc_without_function_23_is_heard_or_it_is_told_what_to_write(
    answers: dict[str, str], troubles: tuple[str, ...], tmp_path: Path
) -> None:
    made = stand(UnusualPlant(fc23=False, answers=answers), tmp_path)
    made.commission(tmp_path / "site.yaml")
    gateway = made.gateway(load_site(tmp_path / "site.yaml"))
    for tick in range(4):
        made.clock.advance_ns(5_000_000)
        command = Command(heartbeat=tick, state_bits=0, echo=0, corrections=(0.0, 0.0), alarm=0,
                          limits=(0.15, 0.04), config_revision=1)  # fmt: skip
        seen = gateway.exchange(command, tick, made.clock.now_ns() + 3_000_000)
    assert seen.outcome is (Outcome.EXCEPTION if troubles else Outcome.OK)
    assert gateway.troubles == troubles
