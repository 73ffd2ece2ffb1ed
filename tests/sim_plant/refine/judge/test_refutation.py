"""A record held out confirms what was found, or refutes it."""

from dataclasses import replace

import numpy as np
import pytest

from sim_plant.refine.judge.holdout import Evaluation
from sim_plant.refine.judge.refutation import (
    as_declared,
    leaves_large,
    leaves_much,
    made_worse,
    refuted,
    shows,
    shows_something_else,
    takes_little,
)
from tests.each_case import each_case

TIME_S = 0.01 * np.arange(4000)
SINE = np.sin(2.0 * np.pi * 1.7 * TIME_S)
"""Response of what was found: power 0.5, that of noise is 1."""
STEP = 4.0 * (TIME_S > 20.0)
DRIFT = 3.0 * np.sin(2.0 * np.pi * 0.02 * TIME_S)
BURST = 12.0 * np.exp(-0.5 * ((TIME_S - 25.0) / 1.5) ** 2)

CHANNELS = ("unwind_tension_N", "pull_roll_speed_m_s", "unwind_angle_rad")


def evaluation(before, after):
    """Return errors as multiples of the floor."""
    series = np.zeros((3, 4))
    return Evaluation(
        channels=CHANNELS,
        rms_declared=np.array(before),
        rms_amended=np.array(after),
        floor=np.ones(3),
        measured=series,
        declared=series,
        corrected=series,
        amended=series + 1.0,
        effects=(),
        angles_rad={"R3": 0.1},
        unwound_m={},
        first=0,
        travel_m=np.zeros(4),
    )


@each_case(
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


@each_case(
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
    assert plain.rms_amended.tolist() == [4.0, 3.0, 1.0]
    assert not plain.amended.any()
    assert plain.angles_rad == {}


@each_case(
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


def in_record(response, rest, seed=0, others=0.0):
    """Return the evaluation of an effect whose response this is, with ``rest`` in the record too.

    Noise of unit size; ``others`` is what the declared line itself has.
    """
    shape = (3, TIME_S.size)
    declared = np.full(shape, others)
    response = np.outer((1.0, 0.5, 0.0), response)
    measured = declared + np.outer((1.0, 0.3, 0.0), rest)
    measured = measured + np.random.default_rng(seed).standard_normal(shape)
    return replace(
        evaluation((1.0, 1.0, 1.0), (1.0, 1.0, 1.0)),
        rms_declared=np.sqrt(np.mean((measured - declared) ** 2, axis=1)),
        rms_amended=np.sqrt(np.mean((measured - declared - response) ** 2, axis=1)),
        measured=measured,
        declared=declared,
        corrected=declared,
        amended=declared + response,
    )


def with_it(response, rest, seed=0):
    """The same where the record has the effect as it was found."""
    bare = in_record(response, rest, seed, others=7.0)
    there = bare.measured + bare.amended - bare.declared
    return replace(
        bare,
        measured=there,
        rms_declared=np.sqrt(np.mean((there - bare.declared) ** 2, axis=1)),
        rms_amended=np.sqrt(np.mean((there - bare.amended) ** 2, axis=1)),
    )


@pytest.mark.parametrize("rest", [STEP, DRIFT, BURST], ids=["step", "drift", "burst"])
@pytest.mark.parametrize("seed", range(5))
def test_something_else_in_the_record_held_out_refutes_nothing_that_is_there(rest, seed):
    there = with_it(2.0 * SINE, rest, seed)
    assert np.mean(rest**2) > np.mean((2.0 * SINE) ** 2)  # it is the stronger one
    assert shows(there, there.declared)
    assert not refuted(there)
    assert shows_something_else(there)


@each_case("seed", range(5))
@each_case("rest", [STEP, DRIFT, BURST, 2.0 * np.roll(SINE, 15)])
def test_what_is_not_there_is_refuted_by_something_else(rest, seed):
    """A sine a quarter of its turn further on is another one: 1.7 Hz, 0.15 s."""
    assert refuted(in_record(SINE, rest, seed))


@pytest.mark.parametrize("size", [0.4, 1.6, 2.5])
def test_a_response_of_another_size_is_not_that_of_the_effect(size):
    there = in_record(2.0 * SINE, 2.0 * size * SINE + STEP)
    assert not shows(there, there.declared)


def with_share(share, response, seed):
    """Return an evaluation of a record that has this share of the response, and noise."""
    bare = in_record(response, 0.0, seed)
    return replace(bare, measured=bare.measured + share * (bare.amended - bare.declared))


@each_case("seed", range(5))
@each_case(
    ("share", "is_refuted"), [(0.0, True), (0.2, True), (0.8, False), (1.0, False), (1.7, False)]
)
def test_a_small_response_that_a_record_could_show_and_lacks_is_refuted(share, is_refuted, seed):
    """Half a percent of the power beyond noise that lets a record be asked what is left of it."""
    small = 0.1 * SINE
    assert refuted(with_share(share, small, seed)) is is_refuted


@each_case("seed", range(5))
def test_the_absence_of_a_response_that_chance_hides_refutes_nothing(seed):
    assert not refuted(with_share(0.0, 0.03 * SINE, seed))


def test_a_response_too_small_to_tell_is_not_shown():
    """Of 400 sets of noise, alone, none shows it; where it is, some of a good size do."""
    small = [in_record(0.02 * SINE, DRIFT, seed) for seed in range(400)]
    assert not any(shows(each, each.declared) for each in small)


def confined(blocks, size):
    """Return a response in so many blocks of 200 samples from 12 s on, 0 elsewhere."""
    inside = np.abs(TIME_S - 12.0 - blocks) < blocks
    return size * SINE * inside


@each_case(("blocks", "is_shown"), [(1, False), (4, False), (6, True), (10, True)])
def test_a_response_in_few_blocks_tells_no_slope(blocks, is_shown):
    """In one the standard deviation of its slope is 0 for any rest: sum(r (y - b r)) is 0."""
    there = with_it(confined(blocks, 4.0), 0.2 * DRIFT)
    assert shows(there, there.declared) is is_shown


def test_a_response_whose_moment_was_sought_in_the_record_is_not_shown_by_it():
    """Among all moments there is one at which most rests have about that slope."""
    there = with_it(2.0 * SINE, STEP)
    sought = replace(there, moments={"bearing_drag at R5": 12.0})
    assert not refuted(there)
    assert refuted(sought)
    assert not takes_little(there, as_declared(there))
    assert takes_little(sought, as_declared(sought))


def test_corrected_numbers_are_no_response_of_the_effect():
    """The numbers alone change what the record shows; the effect beside them is not there."""
    numbers, imitation = 3.0 * SINE, np.sin(2.0 * np.pi * 0.9 * TIME_S)
    found = with_it(numbers, DRIFT + STEP)
    channels = np.array((1.0, 0.5, 0.0))
    amended = found.amended + np.outer(channels, imitation)
    found = replace(
        found,
        corrected=found.amended,
        amended=amended,
        rms_amended=rms_of(found.measured - amended),
    )
    assert shows(found, found.declared)
    assert refuted(found)


def test_beside_nothing_else_there_is_nothing_else():
    there = with_it(2.0 * SINE, 0.0 * STEP)
    assert not refuted(there)
    assert not shows_something_else(there)


@pytest.mark.parametrize(
    ("rest", "there", "little"),
    [
        (STEP, True, False),  # 1.4 of 7 left, of the size that it was found with
        (STEP, False, True),  # not there
        (0.4 * SINE + STEP, False, True),  # another size
    ],
)
def test_a_weak_effect_stays_beside_something_else_where_the_record_shows_it(rest, there, little):
    weak = 1.5 * np.sin(2.0 * np.pi * 0.9 * TIME_S)
    strong = 3.0 * SINE
    both = with_it(strong + weak, rest) if there else with_it(strong, rest)
    amended = both.declared + np.outer((1.0, 0.5, 0.0), strong + weak)
    both = replace(both, amended=amended, rms_amended=rms_of(both.measured - amended))
    fewer = both.declared + np.outer((1.0, 0.5, 0.0), strong)
    without = replace(both, amended=fewer, rms_amended=rms_of(both.measured - fewer))
    assert takes_little(both, without) is little


def rms_of(rest):
    return np.sqrt(np.mean(rest**2, axis=1))


def test_what_the_others_models_can_have_wrong_is_no_effect():
    """A hundredth of what a strong effect explains, at another frequency, and something else."""
    strong = 20.0 * SINE
    weak = 2.0 * np.sin(2.0 * np.pi * 0.9 * TIME_S)
    both = with_it(strong + weak, STEP)
    fewer = both.declared + np.outer((1.0, 0.5, 0.0), strong)
    without = replace(both, amended=fewer, rms_amended=rms_of(both.measured - fewer))
    assert takes_little(both, without)


@each_case(
    ("before", "after", "is_large"),
    [
        ((10.0, 10.0, 1.0), (2.3, 1.0, 1.0), True),  # 4.3 % of 99 in one of two, 2.1 of both
        ((10.0, 10.0, 1.0), (2.2, 1.0, 1.0), False),  # 3.9 % of it, and 1.9 of both
        ((6.0, 1.1, 1.0), (1.7, 1.0, 1.0), False),  # 5 % of 35, and 0.9 in the mean of both
        ((4.0, 4.0, 1.0), (1.5, 1.5, 1.0), True),  # 8 % of 15 in each, 1.25 in the mean
        ((20.0, 2.0, 1.0), (1.5, 1.6, 1.0), False),  # 52 % of 3 in one, of which 0.8 is the mean
        ((20.0, 2.0, 1.0), (1.5, 1.9, 1.0), True),  # 87 % of 3 in one, of which 1.3 is the mean
        ((40.0, 40.0, 90.0), (1.2, 1.2, 80.0), False),  # an angle begins anew in each record
    ],
)
def test_a_cause_named_alone_leaves_no_more_than_right_ones_do(before, after, is_large):
    """Power beyond noise: 4 % of what a channel or all had, from 1 in the mean of two on."""
    assert leaves_large(evaluation(before, after)) is is_large
