"""The bound in Hz: a formula of cycle and drive, held against independent calculations."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.core.bandwidth import band_of, drive_limit_Hz, hold_limit_Hz
from aff_runtime.core.response import MAX_PHASE_ERROR_RAD

GAINS = st.floats(0.5, 1000.0)
DAMPINGS = st.floats(0.3, 5.0)
CYCLES = st.floats(1e-3, 0.1)


def corner(K_rad_s, zeta):
    return K_rad_s / (4.0 * zeta**2)


def cost(frequency_Hz, K_rad_s, c_rad_s):
    """What the reference has to be for a speed of one: the loop's inverse at j omega."""
    s = 2j * math.pi * frequency_Hz
    return abs(1.0 + s * s / (K_rad_s * (s + c_rad_s)))


@given(GAINS, DAMPINGS)
def test_where_the_drive_ends_it_lets_an_eighth_through(K_rad_s, zeta):
    c = corner(K_rad_s, zeta)
    assert cost(drive_limit_Hz(K_rad_s, c), K_rad_s, c) == pytest.approx(8.0, rel=1e-9)


@given(GAINS, DAMPINGS, CYCLES)
def test_the_band_is_the_narrower_of_drive_and_hold(K_rad_s, zeta, cycle_s):
    band = band_of(K_rad_s, corner(K_rad_s, zeta), cycle_s)
    assert 0.0 < band.full_Hz < band.end_Hz
    assert cost(band.end_Hz, K_rad_s, corner(K_rad_s, zeta)) <= 8.0 * (1 + 1e-9)
    # half a cycle more or less on the way leaves the correction one that helps
    assert math.pi * band.end_Hz * cycle_s < MAX_PHASE_ERROR_RAD


@given(GAINS, DAMPINGS, CYCLES, st.floats(1.0, 10.0))
def test_a_faster_drive_and_a_shorter_cycle_never_narrow_it(K_rad_s, zeta, cycle_s, times):
    slow = band_of(K_rad_s, corner(K_rad_s, zeta), cycle_s)
    fast = band_of(times * K_rad_s, corner(times * K_rad_s, zeta), cycle_s)
    short = band_of(K_rad_s, corner(K_rad_s, zeta), cycle_s / times)
    assert min(fast.end_Hz, short.end_Hz) >= slow.end_Hz * (1 - 1e-12)


@pytest.mark.parametrize("cycle_s", [0.001, 0.005, 0.02])
def test_the_image_of_the_hold_is_a_tenth_of_the_order_in_length(cycle_s):
    """A sine held for a cycle each, finely sampled, its spectrum over j omega."""
    fine, periods = 64, 240
    cycles = round(periods / (hold_limit_Hz(cycle_s) * cycle_s))
    f = periods / (cycles * cycle_s)  # whole periods in whole cycles: no leakage
    held = np.repeat(np.sin(2 * np.pi * f * cycle_s * np.arange(cycles)), fine)
    length = np.abs(np.fft.rfft(held))
    length[1:] /= np.fft.rfftfreq(held.size, cycle_s / fine)[1:]
    image = cycles - periods  # bin of 1/T - f
    assert length[image] / length[periods] == pytest.approx(0.1, rel=0.03)


def test_the_euclid_line_keeps_its_band_and_a_fast_one_gets_60_Hz():
    slow, fast = (band_of(K, corner(K, 1.1), T) for K, T in ((15.0, 0.005), (60.0, 0.001)))
    assert 17.0 <= slow.full_Hz < slow.end_Hz <= 19.1
    assert fast.full_Hz > 60.0
    assert band_of(60.0, corner(60.0, 1.1), 0.002) == fast  # the drive decides
    assert band_of(15.0, corner(15.0, 1.1), 0.010) == slow
