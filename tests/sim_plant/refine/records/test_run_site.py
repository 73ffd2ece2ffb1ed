import math

import pytest

from aff_runtime.app.setup.asking.draft import FoundWord
from aff_runtime.app.setup.text.site_text import site_text
from aff_runtime.config.loader import load_site
from sim_plant.refine.records.run_site import run_site
from tests.aff_runtime.app.setup.text.test_site_text import DRAFT
from tests.lockstep.known_response import ROOT


def test_the_shipped_site_file_says_what_its_columns_are():
    site = run_site((ROOT / "config/euclid.yaml").read_text(), "site.yaml")
    assert (site.name, site.speed, site.speed_reference) == ("Euclid", "line_speed_m_s", "")
    assert site.rolls["unwind"] == {"angle": "unwind_angle_rad", "radius": "unwind_radius_m"}
    unwind = site.actuators["unwind"]
    assert (unwind.suffix, unwind.signal, unwind.reference, unwind.count, unwind.roll) == (
        "m_s",
        "unwind_tension_N",
        "tension_ref_N",
        1e-5,
        "unwind",
    )
    assert site.count_sizes["unwind_radius_m"] == pytest.approx(2e-5)  # written as 0.02 mm
    assert site.count_sizes["line_speed_m_s"] == 0.001


def test_what_no_correction_waits_for_is_the_same_for_the_service_and_for_refine():
    for name in ("euclid.yaml", "euclid_blocks.yaml", "euclid_can.yaml", "film.yaml"):
        path = ROOT / "config" / name
        site = run_site(path.read_text(), "site.yaml")
        channels = frozenset(site.count_sizes)
        assert channels - site.needed == load_site(path).recorded_only
    assert "swrap_follower_speed_m_s" in load_site(ROOT / "config/euclid.yaml").recorded_only


@pytest.mark.parametrize("shown", [True, False])
def test_the_set_point_that_setup_maps_is_the_speed_reference_of_its_runs(shown):
    word = FoundWord(address=18, type="i16", order="", scale="0.06 m/min")
    draft = DRAFT.with_word("line_speed_ref_m_s", word) if shown else DRAFT
    site = run_site(site_text(draft, file="line2"), "site.yaml")
    assert site.speed_reference == ("line_speed_ref_m_s" if shown else "")
    assert ("line_speed_ref_m_s" in site.count_sizes) is shown
    assert site.count_sizes.get("line_speed_ref_m_s", 0.001) == pytest.approx(0.001)


def test_units_and_uses_that_a_site_may_have():
    text = (ROOT / "config/euclid.yaml").read_text()
    for old, new in (
        ("#transport_ms: 15", "transport_ms: 12 ms"),
        ("#speed_reference: line_speed_ref_m_s", "speed_reference: line_speed_m_s"),
        (
            "line_speed_m_s: { register: 5, type: i16, scale: 0.001 }",
            "line_speed_m_s: { register: 5, type: i16, scale: 0.06 m/min }",
        ),
        (
            "unwind_angle_rad: { register: 11, type: i32, scale: 4096 counts/turn",
            "unwind_angle_rad: { register: 11, type: i32, scale: -0.5 deg",
        ),
    ):
        assert old in text, old
        text = text.replace(old, new)
    site = run_site(text, "site.yaml")
    assert site.actuators["unwind"].transport_s == pytest.approx(0.012)
    assert site.speed_reference == "line_speed_m_s"
    assert site.count_sizes["line_speed_m_s"] == pytest.approx(0.001)
    assert site.count_sizes["unwind_angle_rad"] == pytest.approx(0.5 * 3.14159265 / 180)


def test_what_a_register_of_an_angle_holds_is_told_by_its_type_and_scale():
    text = (ROOT / "config/euclid.yaml").read_text()
    old = "unwind_angle_rad: { register: 11, type: i32, scale: 4096 counts/turn, wraps: true }"
    assert old in text
    for new, holds in (
        (old, 2**32 / 4096),
        ("unwind_angle_rad: { register: 11, type: u16, scale: -0.01 deg, wraps: true }", 1.82044),
        ("unwind_angle_rad: { register: 11, type: i32, scale: 4096 counts/turn }", None),
        ("unwind_angle_rad: { register: 11, type: f32, scale: 1, wraps: true }", None),
    ):
        held = run_site(text.replace(old, new), "site.yaml").registers_rad
        turns = held["unwind_angle_rad"] / math.tau if "unwind_angle_rad" in held else None
        assert turns == (None if holds is None else pytest.approx(holds, rel=1e-5)), new
    can = run_site((ROOT / "config/euclid_can.yaml").read_text(), "site.yaml")
    assert can.registers_rad == {}
