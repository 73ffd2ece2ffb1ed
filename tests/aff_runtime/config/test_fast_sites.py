"""Cycles of 1 and 2 ms: the shipped film sites, and what follows from their cycle."""

import math
from pathlib import Path

import pytest

from aff_runtime.app.wiring.assemble import overruns_in_a_row
from aff_runtime.app.wiring.site_to_law import probe_params, site_params
from aff_runtime.config.check import check_site
from aff_runtime.config.loader import load_site, read_site

CONFIG = Path(__file__).resolve().parents[3] / "config"


@pytest.mark.parametrize(("name", "cycle_s"), [("film", 0.001), ("film_can", 0.002)])
def test_a_fast_site_is_clean_and_lets_60_Hz_through(name, cycle_s):
    path = CONFIG / f"{name}.yaml"
    # nothing but what the Euclid site says too: an open wire, and orders that meet
    for warning in read_site(path).warnings:
        assert "encrypted" in str(warning) or "meets" in str(warning)
    site = load_site(path)
    assert site.cycle_s == cycle_s
    params = probe_params(site, list(site.actuators))
    assert params.f_max_Hz > site_band(site).end_Hz > 60.0
    assert params.f_max_Hz < 0.5 / cycle_s
    assert any("orders of unwind below 68 Hz" in line for line in check_site(path, []).lines())


def site_band(site):
    return site.actuators["unwind"].drive.band(site.cycle_s)


def test_no_idler_at_full_speed_is_a_glitch():
    site = load_site(CONFIG / "film.yaml")
    for roll in site_params(site).rolls:
        declared = site.rolls[roll.name]
        assert roll.max_omega_rad_s >= 1.5 * site.speed_max_m_s / declared.smallest_radius_m


def test_late_ticks_are_an_overrun_after_the_same_time_at_every_cycle():
    euclid, film = (load_site(CONFIG / f"{n}.yaml") for n in ("euclid", "film"))
    assert overruns_in_a_row(euclid) == 3
    assert overruns_in_a_row(film) == 15
    for site in (euclid, film):
        held_s = site.freshness.hold_after_ms * 1e-3
        assert overruns_in_a_row(site) * site.cycle_s == pytest.approx(held_s)


def test_the_plain_law_is_probed_as_far_as_it_corrects():
    site = load_site(CONFIG / "euclid_blocks.yaml")
    params = probe_params(site, ["unwind"])
    assert params.f_max_Hz == pytest.approx(1.0 / (20.0 * site.cycle_s))
    assert math.isclose(params.louder_from_Hz, 3.0)
