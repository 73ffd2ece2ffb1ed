"""Up to where free spectral lines are looked for, in each coordinate."""

from dataclasses import replace

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.spectra.aliases import whole_orders
from sim_plant.refine.spectra.coordinates import periodic_chi2_reduction, rates_Hz, spectra
from tests.sim_plant.refine.small import LINE, STEP_S, axes_at, white

ROWS = 6000
ROLLS = (LINE.rollers[0], LINE.rollers[-1])
RAMP_M_S = np.linspace(0.8, 1.2, ROWS)


def sampled(axes, every):
    """Return the coordinates of every so many samples."""
    return replace(
        axes,
        sample_time_s=every * axes.sample_time_s,
        time_s=axes.time_s[::every],
        travel_m=axes.travel_m[::every],
        angles_rad=axes.angles_rad[:, ::every],
        speed_m_s=axes.speed_m_s[::every],
    )


def of_order(order, roll, every=1):
    """Return coordinates and spectra of a line so many times per turn of a roll, in noise.

    Of a record whose samples are so many steps apart.
    """
    axes = sampled(axes_at(np.repeat(RAMP_M_S, every), LINE), every)
    wave = 0.5 * np.cos(order * axes.angles_rad[axes.declaration.body(roll.name)])
    return axes, spectra(axes, white((2, ROWS)) + wave)


@pytest.mark.parametrize("roll", ROLLS, ids=lambda r: r.name)
@pytest.mark.parametrize("order", [12.0, 24.0, 30.0])
def test_a_ripple_of_the_motor_of_a_roll_has_its_line_at_every_order(order, roll):
    """Of amplitude a in c channels a line takes N c a^2 / 2 of chi-square, by binning 2 % less.

    Order 30 of the rewind is 48 Hz at the fastest, of records of 10 ms.
    """
    axes, found = of_order(order, roll)
    h = hypothesis(BY_NAME["torque_ripple"], roll.name, (("order", order),))
    chi2_reduction = periodic_chi2_reduction(h, axes, found)
    assert chi2_reduction == pytest.approx(ROWS * 2 * 0.5**2 / 2.0, rel=0.1)
    assert whole_orders(h, [axes], [found]) == [int(order)]


@pytest.mark.parametrize("order", [8.0, 15.0])
def test_slow_samples_have_the_line_of_an_order_that_the_fastest_turns_fold(order):
    """Order 8 of the rewind is 9 to 13 Hz, of samples of 50 ms: half their rate is 10 Hz."""
    roll = ROLLS[1]
    axes, found = of_order(order, roll, every=5)
    h = hypothesis(BY_NAME["torque_ripple"], roll.name, (("order", order),))
    chi2_reduction = periodic_chi2_reduction(h, axes, found)
    assert chi2_reduction == pytest.approx(ROWS * 2 * 0.5**2 / 2.0, rel=0.1)
    assert whole_orders(h, [axes], [found]) == [int(order)]


def test_orders_of_a_roll_go_to_half_the_sample_rate_and_take_no_more_room_than_time():
    _, found = of_order(1.0, ROLLS[0])
    fastest_1_s = 1.2 / (2.0 * np.pi * ROLLS[0].radius_m)
    in_time = found[0].frequency
    own = next(s for s in found if s.roll == ROLLS[0].name)
    assert own.frequency[-1] == pytest.approx(0.98 * 0.5 / STEP_S / fastest_1_s, rel=0.01)
    assert all(s.frequency.size <= in_time.size for s in found)


def test_words_of_an_angle_turn_a_roll_no_faster():
    """An encoder of 256 steps a turn passes one or two of them in a sample: 0.4 turns/s."""
    turns = np.floor(256 * 0.4 * STEP_S * np.arange(ROWS)) / 256
    rates = rates_Hz(turns, axes_at(RAMP_M_S, LINE))
    assert rates == pytest.approx(np.full(rates.size, 0.4), abs=1.0 / 256)
