"""A record held out confirms what was found, or refutes it."""

from dataclasses import replace

import numpy as np
import pytest

from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.judge.refutation import (
    as_declared,
    leaves_much,
    made_worse,
    refuted,
    takes_little,
)

CHANNELS = ("unwind_tension_N", "pull_roll_speed_m_s", "unwind_angle_rad")


def evaluation(before, after):
    """Return errors as multiples of the floor."""
    series = np.zeros((3, 4))
    return Evaluation(
        channels=CHANNELS,
        before=np.array(before),
        after=np.array(after),
        floor=np.ones(3),
        measured=series,
        declared=series,
        amended=series + 1.0,
        effects=(),
        angles_rad={"R3": 0.1},
        unwound_m={},
        first=0,
        travel_m=np.zeros(4),
    )


@pytest.mark.parametrize(
    ("before", "after", "is_refuted"),
    [
        ((4.3, 9.4, 1.0), (4.1, 9.4, 1.0), True),  # explains nothing of it
        ((4.3, 9.4, 1.0), (1.2, 2.0, 1.0), False),
        ((4.3, 9.4, 1.0), (5.0, 12.0, 1.0), True),  # and makes it worse
        ((1.1, 1.2, 1.0), (1.1, 1.2, 1.0), False),  # nothing to explain on this record
        ((1.0, 1.0, 50.0), (1.0, 1.0, 50.0), False),  # an angle begins anew in each record
    ],
)
def test_what_leaves_most_of_a_record_held_out_is_refuted(before, after, is_refuted):
    assert refuted(evaluation(before, after)) is is_refuted


def test_a_line_that_does_not_run_with_what_was_found_refutes_it():
    assert refuted(evaluation((1.0, 1.0, 1.0), (np.nan, np.nan, np.nan)))


def test_a_radius_begins_anew_in_each_record_as_an_angle_does():
    there = evaluation((4.3, 1.6, 1.0), (1.1, 3.6, 1.0))
    radius = ("unwind_tension_N", "unwind_radius_m", "unwind_angle_rad")
    assert not refuted(replace(there, channels=radius))
    assert refuted(there)


def test_half_of_the_power_beyond_noise_is_the_limit():
    before = (np.sqrt(1.0 + 8.0), 1.0, 1.0)
    assert not refuted(evaluation(before, (np.sqrt(1.0 + 3.9), 1.0, 1.0)))
    assert refuted(evaluation(before, (np.sqrt(1.0 + 4.1), 1.0, 1.0)))


@pytest.mark.parametrize(
    ("after", "worse"),
    [
        ((3.0, 1.0, 50.0), ()),  # an angle begins anew in each record
        ((4.0, 1.1, 1.0), ()),  # power of noise 1.21 - 1: as much as chance
        ((3.0, 1.2, 1.0), ("pull_roll_speed_m_s",)),
        ((4.04, 1.2, 1.0), ("unwind_tension_N", "pull_roll_speed_m_s")),
    ],
)
def test_an_effect_that_adds_power_to_a_channel_makes_it_worse(after, worse):
    assert made_worse(evaluation((4.0, 1.0, 1.0), after)) == worse


def test_a_line_as_declared_has_its_own_error_after():
    plain = as_declared(evaluation((4.0, 3.0, 1.0), (2.0, 1.0, 1.0)))
    assert plain.after.tolist() == [4.0, 3.0, 1.0]
    assert not plain.amended.any()
    assert plain.angles_rad == {}


@pytest.mark.parametrize(
    ("with_it", "without_it", "little"),
    [
        ((3.0, 3.0, 1.0), (3.2, 3.3, 1.0), True),  # takes 1.6 of 8 that stay
        ((3.0, 3.0, 1.0), (4.4, 4.4, 1.0), False),  # takes 10.4
        ((3.0, 3.0, 1.0), (2.9, 3.0, 1.0), True),  # and one that makes it worse
        ((3.0, 3.0, 1.0), (3.0, 3.0, 90.0), True),  # an angle begins anew in each record
    ],
)
def test_an_effect_that_takes_less_than_stays_may_be_an_imitation(with_it, without_it, little):
    before = (40.0, 40.0, 1.0)
    found = takes_little(evaluation(before, with_it), evaluation(before, without_it))
    assert found is little


def test_a_record_explained_down_to_its_noise_asks_no_effect_for_more():
    assert not leaves_much(evaluation((9.0, 9.0, 1.0), (1.2, 1.3, 1.0)))
    assert leaves_much(evaluation((9.0, 9.0, 1.0), (1.5, 1.5, 1.0)))
