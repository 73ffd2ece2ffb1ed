from pathlib import Path

import pytest

from aff_runtime.config.loader import load_site
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.report.aff_block import site_name, write_block
from tests import quick_yaml
from tests.each_case import each_case
from tests.sim_plant.refine.small import finding

CONFIG = Path(__file__).parents[4] / "config"
LINE = load_declaration(CONFIG / "lines" / "euclid.yaml")


def block_of(folder, roller):
    found = finding("eccentric_roller", roller, {"eccentricity_m": 2.5e-4, "angle_rad": 1.0})
    return write_block(folder, [found], LINE).read_text()


def test_an_idlers_block_says_how_the_idler_comes_into_the_site_file(tmp_path):
    text = block_of(tmp_path, "R6")
    (said,) = [x.removeprefix("#   ") for x in text.splitlines() if x.startswith("#   ")]
    site = (CONFIG / "euclid.yaml").read_text()
    ours = text[text.index("      - roll") :]  # as it stands: nothing is moved in or out
    site = site.replace("\nrolls:\n", f"\nrolls:\n  {said}\n", 1)
    site = site.replace(
        "      - { roll: swrap_follower", f"{ours}      - {{ roll: swrap_follower", 1
    )
    (tmp_path / "site.yaml").write_text(site)
    loaded = load_site(tmp_path / "site.yaml")
    assert loaded.rolls["r6"].radius_m == LINE.rollers[LINE.body("R6")].radius_m
    assert [b.roll for b in loaded.actuators["unwind"].blocks] == [
        "unwind",
        "r6",
        "swrap_follower",
    ]


@pytest.mark.parametrize(
    ("roller", "drives"), [("R6", "unwind or swrap_lead"), ("R13", "swrap_follower or pull_roll")]
)
def test_an_idlers_block_names_the_drives_on_both_sides(tmp_path, roller, drives):
    assert f"goes to the actuator of {drives}," in block_of(tmp_path, roller)


def test_a_driven_rollers_block_replaces_its_entry_as_it_stands(tmp_path):
    text = block_of(tmp_path, "swrap_follower")
    (block,) = quick_yaml.safe_load(text)["blocks"]
    assert [row["order"] for row in block["start"]] == block["orders"] == [1]
    site = (CONFIG / "euclid.yaml").read_text()
    old = "      - { roll: swrap_follower, orders: [1], settle_s: 10, amp_limit_m_s: 0.01 }\n"
    assert old in site
    (tmp_path / "site.yaml").write_text(site.replace(old, text[text.index("      - roll") :]))
    blocks = load_site(tmp_path / "site.yaml").actuators["unwind"].blocks
    assert [b.roll for b in blocks] == ["unwind", "swrap_follower"]
    assert blocks[1].start[0].deviation_m == pytest.approx(block["start"][0]["deviation_m"])


@each_case(
    ("roller", "name"),
    [("R6", "r6"), ("pull_roll", "pull_roll"), ("Idler 7/b", "idler_7_b"), ("7", "roller_7")],
)
def test_a_rollers_name_becomes_one_that_the_site_file_takes(roller, name):
    assert site_name(roller) == name


def test_a_driven_rollers_block_needs_no_such_word(tmp_path):
    assert "has no drive" not in block_of(tmp_path, "swrap_follower")
