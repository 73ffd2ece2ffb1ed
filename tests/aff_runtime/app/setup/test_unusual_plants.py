"""Setup on unusual plants, in virtual time: a site file that says what the PLC's map says."""

from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.base.signals import Command, Outcome
from aff_runtime.cli.main import main
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Site
from sim_plant.servers.plc_map import PlcMap
from tests.aff_runtime.cli.virtual_line import VirtualLine
from tests.lockstep.plants import (
    PLANTS,
    SECOND,
    SECOND_CHANNEL,
    RefusedAnswerError,
    Stand,
    UnusualPlant,
)

BY_WORDS = [name for name, plant in PLANTS.items() if plant.line is None]
NAMES = {SECOND_CHANNEL: f"{SECOND}_tension_N"}


def stand(plant: UnusualPlant, folder: Path) -> Stand:
    return Stand(plant, VirtualLine(0.005), folder)


def assert_says_what_the_map_says(site: Site, plc: PlcMap) -> None:
    """Every word of the site file is the PLC's own, and reads what the PLC means."""
    read, base = site.gateway.read, site.gateway.address_base

    def at(number: int | None) -> int:
        assert number is not None
        return number - (40001 if base and number >= 40001 else base)

    assert site.gateway.word_order == ("low_first" if plc.low_first else "high_first")
    for name in ("plc_heartbeat", "status", "roll_id", "aff_echo"):
        assert at(getattr(read, name).register_number) == plc.read[name], name
    for name in ("aff_heartbeat", "state", "echo", "alarm", "limit", "config_revision"):
        assert at(getattr(site.gateway.write, name).register_number) == plc.write[name], name
    for row in plc.corrections:
        found = site.gateway.write.corrections[row.item.name]
        assert at(found.register_number) == row.item.address
        assert found.scale == pytest.approx(row.item.scale)
    for item in plc.channels:
        channel = read.channels[NAMES.get(item.name, item.name)]
        said = (at(channel.register_number), channel.wraps)
        assert said == (item.address, item.wraps), item.name
        assert channel.scale == pytest.approx(item.scale, rel=1e-9), item.name
        assert channel.type[1:] == item.type[1:], item.name  # a sign that never shows is no error


@pytest.mark.parametrize("name", BY_WORDS)
@pytest.mark.sweep(every=4)
def test_setup_finds_the_words_of_an_unusual_plant_and_its_file_is_checked(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made = stand(PLANTS[name], tmp_path)
    technician = made.commission(tmp_path / "site.yaml")
    site = load_site(tmp_path / "site.yaml")
    assert_says_what_the_map_says(site, made.map)
    assert main(["check", str(tmp_path / "site.yaml"), "--state-dir", str(tmp_path)]) == 0
    capsys.readouterr()
    assert technician.unasked == ["unwind_angle_rad.pick", f"{SECOND}_angle_rad.pick"]
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


def test_two_lines_on_one_gateway_have_a_site_file_each(tmp_path: Path) -> None:
    sites = {}
    for name, plant in (("film1", UnusualPlant()), ("film2", PLANTS["low words first"])):
        folder = tmp_path / "lines" / name
        folder.mkdir(parents=True)
        made = stand(plant, folder)
        made.commission(folder / "site.yaml")
        sites[name] = load_site(folder / "site.yaml")
        assert main(["check", str(folder / "site.yaml"), "--state-dir", str(folder)]) == 0
        assert_says_what_the_map_says(sites[name], made.map)
    orders = [site.gateway.word_order for site in sites.values()]
    assert orders == ["high_first", "low_first"]


@pytest.mark.parametrize(
    ("answers", "troubles"),
    [
        ({"function": "fc3_fc16"}, ()),
        ({}, ("the PLC does not know function 23 (exception 1): write function: fc3_fc16 into the "
              "site file",)),
    ],
)  # fmt: skip
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
