"""The bench's own parts: geometry, order tracking, verdicts, lockstep."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.control.cases import ON_S, constant_cases, mismatch_cases, roll_duration_s
from benchmarks.control.judge import order_amplitudes, ratio_dB
from benchmarks.control.lines import ALL_FIVE, INCH_M, Hidden, nominal, spoilt, with_hidden
from benchmarks.control.lockstep import run
from benchmarks.control.verdicts import targets
from sim_plant.line.load import consistency


@pytest.mark.parametrize("radius_in", [8.0, 6.375, 4.75, 2.5])
def test_a_line_with_another_radius_is_consistent(radius_in):
    line = nominal("tyvek", radius_in * INCH_M)
    assert consistency(line) == []
    assert line.spans[0].direction_deg == pytest.approx(
        nominal("tyvek", 0.2032).spans[0].direction_deg, abs=12.0
    )


def test_the_declared_radius_gives_the_declared_span_back():
    line = nominal("tyvek", 0.2032)
    assert line.spans[0].length_m == pytest.approx(1.19239, abs=1e-4)
    assert line.spans[0].direction_deg == pytest.approx(1.9771, abs=0.01)


def test_hidden_means_the_declaration_does_not_say_it():
    line = nominal("pe", 0.2032)
    spoilt_line = with_hidden(line, ALL_FIVE)
    assert pytest.approx(0.7 * line.web.EA_N) == spoilt_line.web.EA_N
    assert spoilt_line.web.wound_in_tension_N == pytest.approx(0.5 * line.web.wound_in_tension_N)
    assert {s.low_pass_Hz for s in spoilt_line.sensors if s.low_pass_Hz} == {3.0}


def test_order_tracking_finds_known_amplitudes_beside_another_roll():
    rng = np.random.default_rng(0)
    theta = np.arange(8000) * 0.005 * 5.0
    other = np.arange(8000) * 0.005 * 6.7
    signal = 3.0 + 0.5 * np.cos(theta + 0.4) + 0.2 * np.sin(3 * theta) + 0.7 * np.cos(other)
    found = order_amplitudes(signal + 0.05 * rng.standard_normal(8000), theta, other, 0.005)
    assert found[:3] == pytest.approx([0.5, 0.0, 0.2], abs=0.01)


def test_a_ratio_of_ten_is_twenty_dB():
    assert ratio_dB(np.array([1.0]), np.array([0.1])) == pytest.approx([20.0])


def test_names_of_cases_are_unique():
    for cases in (constant_cases(), mismatch_cases()):
        assert len({c.name for c in cases}) == len(cases)


def test_a_roll_lasts_as_long_as_its_web():
    case = constant_cases()[3]
    web_m = math.pi * ((8 * INCH_M) ** 2 - (2.5 * INCH_M) ** 2) / case.line().web.thickness_m
    assert roll_duration_s(case) == pytest.approx(web_m / case.speed_m_s)


def test_a_silent_law_leaves_the_line_as_it_is_and_the_seed_decides():
    line = spoilt(nominal("tyvek", 0.2032), shape="flat", lead_m=0.0, follower_m=0.0)
    speed = np.full(400, 1.016)
    a = run(line, {}, speed, seed=1, on_s=ON_S)
    b = run(line, {}, speed, seed=1, on_s=ON_S, hidden=Hidden(delay_s=0.05))
    c = run(line, {}, speed, seed=2, on_s=ON_S)
    assert (a.tension_N == b.tension_N).all()
    assert (a.tension_N != c.tension_N).any()
    assert not a.correction_m_s.any()


def test_targets_say_what_share_of_rows_meets_them():
    row = {
        "section": "follower", "law": "follower and unwind", "case": "x", "seed": 1,
        "pullroll_1x_dB": 35.0, "pullroll": 0.1, "unwind": 1.2, "follower_speed": 1.0,
    }  # fmt: skip
    found = {t.what: t.met for t in targets([row])}
    assert found["4 follower, pull-roll 1x"] == "yes"
    assert found["4 unwind tension meanwhile"] == "0 % of rows"
