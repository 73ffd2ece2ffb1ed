"""What a record can show at all, told by the generator alone."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from benchmarks.campaign import alike as told_by
from benchmarks.campaign import record as recording
from benchmarks.campaign import stage as staging
from benchmarks.campaign.alike import (
    Quiet,
    alike,
    apart,
    beside,
    merged,
    rivals,
    tolerated,
    wavenumber,
    whitener,
)
from benchmarks.campaign.cases import Case
from benchmarks.campaign.fault import Fault
from benchmarks.campaign.stage import stage, tolerances

pytestmark = pytest.mark.timeout(300)


@pytest.fixture(scope="module", autouse=True)
def half_as_long():
    """Take 30 s of a line that has settled for 20 s, not 60 s after 40 s, as the campaign does."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(staging, "ROWS", 3000)
        patch.setattr(recording, "SETTLE_S", 20.0)
        yield


@pytest.fixture(scope="module")
def record():
    return Quiet.of(stage(Case(number=0, group="single", seed=3), "a"))


def sized(record, fault, chi_square=1000.0):
    true = record.response(fault)
    return replace(fault, size=fault.size * float(np.sqrt(chi_square / (true @ true))))


@pytest.mark.long
def test_an_unbalance_at_a_drive_is_a_ripple_of_order_1(record):
    fault = sized(record, Fault(effect="unbalanced_roller", location="swrap", size=5e-3))
    assert ("torque_ripple", "swrap") in alike(record, fault)


def unbalanced(record, place, chi_square):
    fault = Fault(effect="unbalanced_roller", location=place, size=5e-3, angle=0.4)
    return sized(record, fault, chi_square)


@pytest.mark.long  # quick: on formulas, below
@pytest.mark.parametrize(("chi_square", "hidden"), [(300.0, True), (30_000.0, False)])
@pytest.mark.sweep(every=2)
def test_two_weak_rollers_of_one_radius_answer_like_one_between_them(
    record, monkeypatch, chi_square, hidden
):
    between = Fault(effect="unbalanced_roller", location="R2", size=5e-3)
    monkeypatch.setattr(told_by, "rivals", lambda _: [between])
    one, other = (unbalanced(record, place, chi_square) for place in ("R1", "R3"))
    cos, sin = (record.response(replace(other, angle=a)) for a in (0.0, 0.5 * np.pi))
    true = record.response(one)
    in_phase = replace(other, angle=float(np.arctan2(true @ sin, true @ cos)))
    expected = [("unbalanced_roller", "R2")] if hidden else []
    assert merged(record, [one, in_phase]) == [expected, expected]


@pytest.mark.long
def test_rollers_of_different_radius_are_not_merged(record):
    faults = [unbalanced(record, "R1", 300.0), unbalanced(record, "swrap", 300.0)]
    assert merged(record, faults) == [[], []]


@pytest.mark.long
def test_an_idler_alone_in_its_zone_is_told_by_its_line(record):
    fault = sized(record, Fault(effect="eccentric_roller", location="R5", size=5e-6, angle=0.4))
    assert alike(record, fault) == []


def test_noise_of_a_known_recursion_is_made_white():
    noise = lfilter([0.3], [1.0, -0.8], np.random.default_rng(1).standard_normal(20000))
    taps = whitener(noise)
    np.testing.assert_allclose(taps[:3], np.array([1.0, -0.8, 0.0]) / 0.3, atol=0.1)


def test_lines_of_one_wavenumber_are_rivals_and_others_are_none():
    fault = Fault(effect="eccentric_roller", location="R2", size=1e-5)
    assert wavenumber(fault) == pytest.approx(1.0 / (2.0 * np.pi * 0.0381))
    found = {(r.effect, r.location, r.shape) for r in rivals(fault)}
    assert ("torque_ripple", "pull_roll", 2.0) in found  # twice the radius
    assert not {place for _, place, _ in found} & {"R5", "R7", "swrap", "unwind"}


def test_what_is_left_beside_columns_is_their_distance():
    true, other = np.array([3.0, 4.0, 0.0]), np.array([[1.0], [0.0], [0.0]])
    assert apart(true, other) == pytest.approx(16.0)


def test_tolerances_take_up_what_answers_like_them_at_the_price_of_their_priors():
    column = np.array([[3.0], [0.0], [4.0]])  # |c|^2 = 25: a true x costs x^2 25/26
    assert beside(4.0 * column[:, 0], column) == pytest.approx(16.0 * 25.0 / 26.0)
    assert beside(np.array([0.0, 7.0, 0.0]), column) == pytest.approx(49.0)


@pytest.mark.long
def test_a_modulus_within_four_standard_deviations_hardly_shows(record):
    case = Case(number=0, group="single", seed=3)
    modulus = tolerances(case)[1]
    stiffer = stage(case, "a", modulus).machine.modulus / stage(case, "a").machine.modulus
    assert stiffer == pytest.approx(1.01, abs=3e-4)
    fault = Fault(effect="web_modulus", location="web", size=4.0 * 0.5 * 0.02)
    true = record.response(fault)
    assert beside(true, tolerated(case, record, [modulus])) < 16.5 < 0.1 * float(true @ true)


@pytest.mark.long
def test_web_warm_between_two_speeds_is_a_wrong_zero_of_the_cell_there(record):
    fault = Fault(effect="thermal_strain", location="pull_roll_zone", size=1e-3)
    assert alike(record, fault) == [("load_cell_calibration", "R5")]
    slow = Fault(effect="load_cell_filter", location="R5", size=0.1)
    assert alike(record, slow) == []


def test_what_only_a_tolerance_makes_alike_is_alike_beside_it():
    true, other = np.array([3.0, 4.0, 0.0]), np.array([[1.0], [0.0], [0.0]])
    assert apart(true, other, np.array([[0.0], [100.0], [0.0]])) < 0.01
    assert apart(true, other, np.array([[0.0], [1.0], [0.0]])) == pytest.approx(8.0)
