"""A counter's readings unfolded, against the angle that was counted."""

import math

import numpy as np
import pytest

from aff_runtime.base.runs.counted_angle import (
    counted_angle,
    early_wrap,
    is_whole_turns,
    modulus_rad,
    range_counts,
)
from aff_runtime.base.yaml_section import Section
from tests.each_case import each_case

TIME_S = np.arange(12_000) * 0.005
TURNS = {"0.7": 0.7, "1": 1.0, "13.1072": 13.1072, "16": 16.0, "never": math.inf}


def counted(angle, turns, keep=None):
    """Return what a counter of so many turns makes of an angle, and the truth beside it."""
    keep = np.ones(angle.size, dtype=bool) if keep is None else keep
    modulus = turns * math.tau
    count = np.mod(angle + 1.0, modulus) if math.isfinite(modulus) else angle + 1.0
    return counted_angle(TIME_S[keep], count[keep], modulus), (angle - angle[0])[keep]


@each_case("turns", TURNS.values(), ids=TURNS)
@each_case("way", [1.0, -1.0])
def test_from_rest_to_speed_and_back_the_angle_is_the_true_one(turns, way):
    speed = 40.0 * np.interp(TIME_S, [5.0, 15.0, 35.0, 50.0], [0.0, 1.0, 1.0, 0.0])
    found, truth = counted(way * np.cumsum(speed) * 0.005, turns)
    assert np.max(np.abs(found.angle_rad - np.abs(truth))) < 1e-6
    assert found.good.all()
    assert not found.part.any()


@each_case("turns", TURNS.values(), ids=TURNS)
def test_over_a_hole_the_speed_around_it_says_how_often_the_count_started_over(turns):
    """The hole is 60 rad long; known within 2 %, no other range than the right one is near."""
    keep = (TIME_S < 20.0) | (TIME_S >= 26.0)
    found, truth = counted(10.0 * TIME_S + 0.01 * TIME_S**2, turns, keep)
    assert np.max(np.abs(found.angle_rad - truth)) < 1e-6
    assert np.flatnonzero(~found.good).tolist() == [4000]
    assert not found.part.any()


def test_over_a_long_hole_a_range_of_whole_turns_keeps_the_phase_and_another_says_it_is_lost():
    """60 s at about 10 rad/s are known to two turns."""
    time_s = np.concatenate([TIME_S[:2000], TIME_S[:2000] + 70.0])
    angle = 10.0 * time_s + 0.3 * np.sin(time_s / 60.0 * math.tau)
    angle[2000:] += 11.0  # the roll ran a little faster in the hole
    whole = counted_angle(time_s, np.mod(angle, math.tau), math.tau)
    off = np.mod(whole.angle_rad - (angle - angle[0]) + math.pi, math.tau) - math.pi
    assert np.max(np.abs(off)) < 1e-6
    assert not whole.part.any()
    other = counted_angle(time_s, np.mod(angle, 1.31 * math.tau), 1.31 * math.tau)
    assert np.array_equal(other.part, np.arange(4000) >= 2000)
    assert np.flatnonzero(~other.good).tolist() == [1999, 2000]


@each_case("turns", TURNS.values(), ids=TURNS)
def test_what_lacks_is_bridged_and_rows_at_the_ends_without_a_reading_are_no_good(turns):
    rng = np.random.default_rng(1)
    lacks = rng.random(TIME_S.size) < 0.3
    lacks[[0, 1, -1]], lacks[[2, -2]] = True, False
    modulus = turns * math.tau
    truth = 30.0 * TIME_S
    count = np.mod(truth, modulus) if math.isfinite(modulus) else truth.copy()
    count[lacks] = math.nan
    found = counted_angle(TIME_S, count, modulus)
    inside = slice(2, -1)
    assert np.max(np.abs(found.angle_rad - truth + truth[2])[inside]) < 1e-6
    assert not found.good[[0, 1, -1]].any()
    assert found.good[inside].mean() > 0.95  # where not four and more lack in a row


def test_readings_that_are_none_have_no_angle():
    for size, count in ((0, 0), (3, 0), (3, 1)):
        values = np.full(size, math.nan)
        values[:count] = 1.0
        found = counted_angle(np.arange(size) * 0.005, values, math.tau)
        assert found.angle_rad.shape == found.part.shape == (size,)
        assert not found.good.any()


def test_a_clock_that_goes_back_and_rows_of_noise_end():
    rng = np.random.default_rng(2)
    for time_s in (np.zeros(5000), rng.random(5000), -np.arange(5000.0)):
        for modulus in (math.tau, 1.3 * math.tau, math.inf):
            found = counted_angle(time_s, 1e6 * rng.standard_normal(5000), modulus)
            assert np.isfinite(found.angle_rad).all()
            assert (np.diff(found.angle_rad) >= 0.0).all()


@each_case("sign", [1.0, -1.0])
@each_case("begins_turns", [0.0, 120.0])
def test_a_count_that_was_unfolded_when_it_was_recorded_goes_on_beyond_its_range(
    sign, begins_turns
):
    angle = 30.0 * TIME_S
    found = counted_angle(TIME_S, sign * (begins_turns * math.tau + angle), 16.0 * math.tau)
    assert found.good.all()
    assert np.max(np.abs(found.angle_rad - angle)) < 1e-6


@each_case(
    ("word", "scale", "turns"),
    [
        ("u16", "4096 counts/turn", 16.0),
        ("i16", "-5000 counts/turn", 13.1072),
        ("u16", "65536 counts/turn", 1.0),
        ("i32", 0.001, 2**32 * 0.001 / math.tau),
        ("u32", "0.1 deg", 2**32 / 3600.0),
    ],
)
def test_the_range_of_a_word_is_its_counts_times_what_one_is(word, scale, turns):
    channel = {"register": 3, "type": word, "scale": scale, "wraps": True}
    assert modulus_rad(Section(channel)) == pytest.approx(turns * math.tau)
    assert modulus_rad(Section(channel | {"wraps": False})) == math.inf
    assert is_whole_turns(turns * math.tau) == (turns in (1.0, 16.0))


def test_a_count_that_starts_over_within_its_word_has_the_range_that_is_given():
    channel = {"type": "u16", "scale": "3600 counts/turn", "wraps": True, "wraps_after": 7200}
    assert modulus_rad(Section(channel)) == pytest.approx(2.0 * math.tau)
    for said in (0, -1, "x", True, 7, 65537, 10**400):
        assert modulus_rad(Section(channel | {"wraps_after": said})) == pytest.approx(
            65536 / 3600 * math.tau
        )


@each_case(
    "given",
    [
        {},
        {"signal": "PLC.Angle", "scale": 1.0, "wraps": True},  # CAN: the reader unfolds it
        {"type": 3, "scale": 1.0, "wraps": True},
        {"type": ["u16"], "scale": 1.0, "wraps": True},
        {"type": "u16", "scale": "5 mm", "wraps": True},
        {"type": "u16", "wraps": True},
        {"type": "u16", "scale": 0, "wraps": True},
    ],
)
def test_a_channel_that_does_not_say_its_range_has_none(given):
    assert modulus_rad(Section(given)) == math.inf


def as_the_gateway_records_it(counts, whole):
    """Return readings of a word, each step the short way round of ``whole`` counts."""
    steps = np.mod(np.diff(counts) + whole / 2, whole) - whole / 2
    return counts[0] + np.append(0.0, np.cumsum(steps))


EARLY = [(3600, 64800), (4096, 4096), (3600, 3600), (5000, 40000)]


@pytest.mark.parametrize(("per_turn", "after"), EARLY)
@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("is_unfolded", [True, False])
def test_of_a_count_that_starts_over_early_the_key_and_its_value_are_named(
    per_turn, after, way, is_unfolded
):
    """A roll out of round by a hundredth, 1.9 turns a second; some readings are a cycle late."""
    rng = np.random.default_rng(4)
    turned = way * (1.9 * TIME_S + 0.01 / math.tau * np.sin(math.tau * 1.9 * TIME_S))
    turned -= way * 1.9 * 0.005 * (rng.random(TIME_S.size) < 0.02)
    counts = np.mod(np.floor(turned * per_turn + 17.0), after)
    counts = as_the_gateway_records_it(counts, 65536) if is_unfolded else counts
    channel = Section({"type": "u16", "wraps": True, "scale": f"{per_turn} counts/turn"})
    modulus = modulus_rad(channel)
    found = early_wrap(TIME_S, counts / per_turn * math.tau, modulus)
    times = math.floor(abs(turned[-1]) * per_turn / after)
    assert found.seen == pytest.approx(times, abs=1 + 0.04 * times)
    said = found.words(modulus, range_counts(channel))
    assert said.startswith(f"its count starts over after {after} counts (seen ")
    assert said.endswith(
        f"not after 65536, and the service loses its phase each time: write wraps_after: {after}"
    )


@pytest.mark.parametrize("turns", TURNS.values(), ids=TURNS)
def test_a_count_that_starts_over_where_it_should_is_not_said_to_do_it_early(turns):
    """Set anew twice, and with a hole, it does not either."""
    rng = np.random.default_rng(4)
    angle = 12.0 * TIME_S + 0.05 * np.sin(12.0 * TIME_S) - 0.06 * (rng.random(TIME_S.size) < 0.02)
    angle[4000:] -= 1.0
    angle[8000:] -= 1.0
    keep = (TIME_S < 30.0) | (TIME_S > 33.0)
    modulus = turns * math.tau
    count = np.mod(angle, modulus) if math.isfinite(modulus) else angle
    assert early_wrap(TIME_S[keep], count[keep], modulus) is None
