"""Law shape in the site file: what it needs, what falls back, what check says it will do."""

import re
from pathlib import Path

import pytest

from aff_runtime.base.errors import ConfigError
from aff_runtime.config.check import check_site
from aff_runtime.config.diff import diff_sites
from aff_runtime.config.loader import load_site, read_site

ROOT = Path(__file__).parents[3]
SHAPE = (ROOT / "config" / "euclid.yaml").read_text(encoding="utf-8")
DRIVE = re.search(r"    drive:\n(?:      .*\n)+", SHAPE)
assert DRIVE is not None


def site(tmp_path, *edits):
    """Write the shipped site file with (old, new) edits; return its path."""
    text = SHAPE
    for old, new in edits:
        assert old in text, old
        text = text.replace(old, new, 1)
    path = tmp_path / "site.yaml"
    path.write_text(text, encoding="utf-8")
    return path


START = "        #start: [{ order: 1, deviation_m: 0.7 mm, angle_rad: 40 deg }]"
CASES = {
    "two dampings": (
        ("      zeta: 1.1", "      zeta: 1.1\n      integral_time_s: 0.3"),
        "drive:",
        "actuators.unwind.drive: zeta and integral_time_s both say how the speed loop is damped.",
    ),
    "no damping": (
        ("      zeta: 1.1\n", ""),
        "drive:",
        "actuators.unwind.drive: needs one of zeta and integral_time_s.",
    ),
    "unknown roll": (
        ("      roll: unwind\n      # Speed", "      roll: unwnd\n      # Speed"),
        "unwnd",
        "actuators.unwind.drive.roll: unwnd is no roll. Did you mean unwind?",
    ),
    "core above the smallest radius": (
        ("core_radius_m: 1.75 in", "core_radius_m: 5 in"),
        "5 in",
        "actuators.unwind.drive.core_radius_m: 0.127 m is not above 0 and at most the smallest "
        "radius 0.1016 m of unwind. Write the radius of the core.",
    ),
    "inertia in another unit": (
        ("inertia_kg_m2: 0.25", "inertia_kg_m2: 0.25 N"),
        "0.25 N",
        'actuators.unwind.drive.inertia_kg_m2: "0.25 N" is a force, expected a moment of inertia: '
        "a number in kg m2, or with its unit (kg m^2, kgm2, kg cm2).",
    ),
    "inertia of another power of ten": (
        ("inertia_kg_m2: 0.25", "inertia_kg_m2: 0.25 kg cm2"),
        "0.25 kg cm2",
        # 400 N at 0.1016 m on 1e5 rad/s2: 4.06e-4 kg m2
        "actuators.unwind.drive.inertia_kg_m2: 0.000025 kg m2 with its motor: the tension would "
        "turn such a roll faster than any roll turns. At least 0.0004 kg m2;",
    ),
    "speed loop that hardly acts": (
        ("speed_gain_rad_s: 15", "speed_gain_rad_s: 0.001"),
        "0.001",
        "actuators.unwind.drive.speed_gain_rad_s: 0.001",
    ),
    "start of an order that no block has": (
        (START, "        start: [{ order: 40, deviation_m: 0.001, angle_rad: 0 }]"),
        "40,",
        "actuators.unwind.blocks[0].start[0].order: order 40 is none of this block's",
    ),
    "start above the limit": (
        (START, "        start: [{ order: 1, deviation_m: 20 mm, angle_rad: 0 }]"),
        "20 mm",
        "actuators.unwind.blocks[0].start[0].deviation_m: 0.02 m is above shape_limit_m 0.015 m.",
    ),
    "noise in the wrong unit": (
        ("reference: tension_ref_N } # noise_N: 0.6", "reference: tension_ref_N, noise_m_s: 1 }"),
        "noise_m_s",
        "actuators.unwind.error.noise_m_s: the signal is in N. Remove it.",
    ),
    "no tension known": (
        (
            "error: { signal: unwind_tension_N, reference: tension_ref_N }",
            "error: { signal: unwind_tension_N }",
        ),
        "drive:",
        "actuators.unwind.drive.tension_N: required key is missing: error has no reference.",
    ),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_a_bad_drive_is_refused_at_its_place(case, tmp_path):
    edit, needle, said = case
    path = site(tmp_path, edit)
    with pytest.raises(ConfigError) as refused:
        load_site(path)
    finding = next(line for line in str(refused.value).splitlines() if said in line)
    number = int(finding.removeprefix(f"{path}:").split(":")[0])
    assert needle in path.read_text().splitlines()[number - 1]


def test_without_a_drive_the_plain_blocks_stand_in_and_check_says_so(tmp_path):
    path = site(tmp_path, (DRIVE.group(), ""))
    reading = read_site(path)
    assert not reading.site.actuators["unwind"].uses_shape
    (warning,) = [w for w in reading.warnings if w.path == "actuators.unwind.law"]
    assert "the plain blocks stand in. Add drive (roll" in warning.text


def test_a_drive_that_no_law_uses_is_a_warning(tmp_path):
    reading = read_site(site(tmp_path, ("    law: shape", "    law: blocks")))
    assert any(w.path == "actuators.unwind.drive" for w in reading.warnings)


def test_a_torque_reference_cannot_run_the_shape_law(tmp_path):
    path = site(tmp_path, ("output: velocity_reference", "output: torque_reference"))
    with pytest.raises(ConfigError, match="law shape corrects a velocity_reference"):
        load_site(path)


def test_check_says_what_the_law_will_do(tmp_path):
    report = check_site(site(tmp_path), [1.016, 1.524])
    said = [line for line in report.lines() if "law shape" in line]
    # 17 Hz * 2 pi * 0.1016 m / 1.016 m/s = 10.7 orders, 19 Hz: 11.9; 1.524 m/s: 7.1 and 7.9
    assert "10 of 16 orders of unwind below 17 Hz, 1 fade, 5 above 19 Hz rest" in said[0]
    assert "7 of 16 orders of unwind below 17 Hz, 9 above 19 Hz rest" in said[2]
    # a turn at 0.1016 m and 1.016 m/s: 0.628 s; nine of them
    assert "memory 9 turns = 5.7 s" in said[0]
    assert any("unwind 1x meets swrap_follower 1x" in line for line in report.lines())


def test_integral_time_is_damping_in_other_words(tmp_path):
    # Ti = 4 zeta^2 / K: 4 * 1.21 / 15 = 0.32267 s
    edit = ("      zeta: 1.1", "      integral_time_s: 0.32266667")
    drive = load_site(site(tmp_path, edit)).actuators["unwind"].drive
    assert drive is not None
    assert drive.damping == pytest.approx(1.1)


def test_a_motor_behind_a_gear_counts_with_the_square_of_its_ratio(tmp_path):
    edit = (
        "      zeta: 1.1",
        "      zeta: 1.1\n      motor_inertia_kg_m2: 20 kg cm2\n      gear_ratio: 10",
    )
    drive = load_site(site(tmp_path, edit)).actuators["unwind"].drive
    assert drive is not None
    assert drive.total_inertia_kg_m2 == pytest.approx(0.25 + 0.002 * 100)


@pytest.mark.parametrize(
    ("edit", "live"),
    [
        (("memory_turns: 9", "memory_turns: 12"), True),
        (("    #shape_limit_m: 15 mm", "    shape_limit_m: 5 mm"), True),
        (("    limit_m_s: 0.15", "    limit_m_s: 0.1"), True),
        (("14, 15, 16]", "14]"), True),
        (("    law: shape", "    law: blocks"), False),
        (("inertia_kg_m2: 0.25", "inertia_kg_m2: 0.3"), False),
        ((START, "        start: [{ order: 1, deviation_m: 0.001, angle_rad: 0 }]"), False),
    ],
)
def test_tuning_applies_at_once_and_the_drive_waits_for_bypass(edit, live, tmp_path):
    before = load_site(ROOT / "config" / "euclid.yaml")
    changes = diff_sites(before, load_site(site(tmp_path, edit)))
    assert changes
    assert all(change.may_change_while_active is live for change in changes)
    assert all(change.path.startswith("actuators.unwind") for change in changes)
