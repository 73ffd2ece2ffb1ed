"""What a record can show at all, told by the generator alone."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from benchmarks.campaign.alike import Quiet, alike, apart, evidence, rivals, wavenumber, whitener
from benchmarks.campaign.cases import Case
from benchmarks.campaign.effects import Fault
from benchmarks.campaign.make import stage

pytestmark = pytest.mark.timeout(300)


@pytest.fixture(scope="module")
def record():
    return Quiet.of(stage(Case(number=0, group="single", seed=3), "a"))


def sized(record, fault, chi_square=1000.0):
    true = record.response(fault)
    return replace(fault, size=fault.size * float(np.sqrt(chi_square / (true @ true))))


def test_an_unbalance_at_a_drive_is_a_ripple_of_order_1(record):
    fault = sized(record, Fault(effect="unbalanced_roller", location="swrap", size=5e-3))
    assert ("torque_ripple", "swrap") in alike(record, fault)


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


def test_a_drag_within_its_tolerance_hardly_shows(record):
    fault = sized(record, Fault(effect="bearing_drag", location="R3", size=2e-3), 1e9)
    four_sd = replace(fault, size=4.0 * 0.5 * 0.05 * 0.0172)
    assert evidence(record, four_sd) < 16.0
