"""Which numbers of a drive are in use: declared before identified, and what is refused."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from aff_runtime.config.identified_drive import with_identified
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Site
from aff_runtime.core.identified import Estimate, IdentifiedDrive
from tests.aff_runtime.core.test_identified import drive, estimate, response

EUCLID = Path(__file__).resolve().parents[3] / "config" / "euclid.yaml"
DRIVE = re.compile(r"^    drive:\n(?:      .*\n)+", re.MULTILINE)
WEB = (
    "    drive:\n      roll: unwind\n      web_density_kg_m3: 395\n      web_width_m: 6 in\n"
    "      core_radius_m: 1.75 in\n"
)
DENSITY, WIDTH_M, CORE_M = 395.0, 0.1524, 0.04445


def site(tmp_path: Path, declared: str) -> Site:
    path = tmp_path / "site.yaml"
    path.write_text(DRIVE.sub(declared, EUCLID.read_text(), count=1))
    return load_site(path)


def filled(tmp_path: Path, declared: str, found: IdentifiedDrive | None):
    read = site(tmp_path, declared)
    whole, used = with_identified(read, {"unwind": response(found)})
    return whole.actuators["unwind"], used[0].text


def test_a_declared_drive_wins_over_an_identified_one():
    read = load_site(EUCLID)
    whole, used = with_identified(read, {"unwind": response(drive())})
    assert whole == read
    assert str(used[0]) == "unwind: drive as declared"


def test_without_a_drive_the_identified_one_stands_in_with_the_whole_inertia(tmp_path):
    actuator, text = filled(tmp_path, "", drive())
    assert actuator.uses_shape
    assert actuator.drive.speed_gain_rad_s == 15.0
    assert actuator.drive.integral_time_s == pytest.approx(0.32)
    assert actuator.drive.total_inertia_kg_m2 == pytest.approx(0.41)
    assert actuator.drive.transport_ms == pytest.approx(15.0)
    assert "drive identified" in text
    assert "15 (13.5 to 16.5) rad/s" in text


def test_a_declared_web_is_taken_out_of_the_inertia(tmp_path):
    actuator, _ = filled(tmp_path, WEB, drive())
    web = 0.5 * math.pi * DENSITY * WIDTH_M * (0.2**4 - CORE_M**4)
    assert actuator.drive.inertia_kg_m2 == pytest.approx(0.41 - web, rel=1e-3)


def test_one_declared_number_wins_and_the_rest_is_identified(tmp_path):
    actuator, text = filled(tmp_path, WEB + "      inertia_kg_m2: 0.3\n", drive())
    assert actuator.drive.inertia_kg_m2 == 0.3
    assert actuator.drive.speed_gain_rad_s == 15.0
    assert "declared: inertia_kg_m2" in text


@pytest.mark.parametrize(
    ("declared", "found", "said"),
    [
        ("", None, "an unknown time identified no drive: the file"),
        ("", drive(inertia_kg_m2=estimate(0.4, 0.5)), "inertia_kg_m2 is not sure enough"),
        ("", drive(speed_gain_rad_s=estimate(0.1)), "identified speed_gain_rad_s is 0.1"),
        (WEB, drive(inertia_kg_m2=estimate(0.14)), "mend web_density_kg_m3"),
        (WEB.replace("unwind", "swrap_follower"), drive(), "the drive turns swrap_follower"),
        (
            "",
            drive(integral_time_s=Estimate(value=0.1, low=-0.1, high=0.3)),
            "integral_time_s is not shown: its 95 % interval -0.1 to",
        ),
    ],
)
def test_what_cannot_be_used_leaves_the_plain_blocks_and_says_why(tmp_path, declared, found, said):
    if "swrap_follower" in declared:
        declared = "    drive:\n      roll: swrap_follower\n"
    actuator, text = filled(tmp_path, declared, found)
    assert actuator.law_that_runs == "blocks"
    assert text.startswith("plain blocks stand in: ")
    assert said in text
