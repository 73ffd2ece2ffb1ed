"""Orders by a counted angle that starts over and has holes: as large as without them."""

import math
import re
import shutil
from functools import cache

import numpy as np
import pytest

from aff_runtime.app.report.comparison.comparing import compare, estimates
from aff_runtime.app.report.comparison.window import roll_angle
from aff_runtime.app.report.watching.run_hours import run_hours
from aff_runtime.base.runs.window import RunWindow
from aff_runtime.base.yaml_section import Section
from tests.aff_runtime.app.card.measure.recorded import (
    CYCLE_S,
    SITE_FILE,
    in_memory,
    recorded,
    steady,
)
from tests.aff_runtime.app.card.measure.recorded import window as window_in

RIPPLE_N, NOISE_N = 2.0, 0.25
ROLL, COUNT, SIGNAL = "swrap_follower", "swrap_follower_angle_rad", "pullroll_tension_N"
RADIUS_M = 1.0 / (2.0 * math.pi * 1.91)  # 1.91 turns a second at 1 m/s
NEVER = "i32, scale: 4096 counts/turn"
WORDS = {
    # turns after which the count starts over: the word, and counts per turn
    None: (2**32, 4096, NEVER),
    1.0: (2**16, 65536, "u16, scale: 65536 counts/turn, wraps: true"),
    1.31072: (2**16, 50000, "u16, scale: 50000 counts/turn, wraps: true"),
    13.1072: (2**16, 5000, "u16, scale: 5000 counts/turn, wraps: true"),
    16.0: (2**16, 4096, "u16, scale: 4096 counts/turn, wraps: true"),
}
SEGMENT_S = 10.0
RATE_Hz, FASTER, FROM_S = 1.91, 0.115, 10.0
"""Turns per second, and the share by which the roll turns faster from some time on."""


def site_text(modulus):
    """Return the shipped site file with the follower's counter in another word."""
    text, count = re.subn(
        rf"({COUNT}:\s+{{ register: 13, type: )i32, scale: 4096 counts/turn, wraps: true",
        rf"\g<1>{WORDS[modulus][2]}",
        SITE_FILE.read_text(),
    )
    assert count == 1
    return text


def columns(seconds, modulus, rate_Hz=RATE_Hz, phase_rad=0.3, faster=0.0):
    """Return a record with a ripple once per turn of the follower, its counter as the word has it.

    ``faster`` : share by which the roll turns faster from ``FROM_S`` on.
    """
    found = steady(seconds)
    time_s = found["time_s"]
    angle = math.tau * rate_Hz * (time_s + faster * np.maximum(time_s - FROM_S, 0.0))
    values, per_turn, _ = WORDS[modulus]
    counts = np.floor(angle / math.tau * per_turn + 0.37 * values) % values
    rng = np.random.default_rng(3)
    noise = NOISE_N * rng.standard_normal(time_s.size)
    found[COUNT] = counts * math.tau / per_turn
    found[SIGNAL] = 60.0 + RIPPLE_N * np.cos(angle + phase_rad) + noise
    return found


def without(found, *spans):
    """Return the record without the rows within these times."""
    time_s = found["time_s"]
    keep = np.ones(time_s.size, dtype=bool)
    for from_s, to_s in spans:
        keep &= (time_s < from_s) | (time_s >= to_s)
    return {name: values[keep] for name, values in found.items()}


def of(folder, found, modulus):
    """Return estimate and frequency of the follower's first order in a record."""
    window = in_memory(folder, found, site_text=site_text(modulus))
    angle = roll_angle(window, window.section("rolls").section(ROLL))
    return estimates(angle, window.readings(SIGNAL), window, [1])[1]


def assert_true(got):
    estimate, frequency_Hz = got
    assert estimate.low - 0.01 <= RIPPLE_N <= estimate.high + 0.01
    assert estimate.amplitude == pytest.approx(RIPPLE_N, abs=0.02)
    assert frequency_Hz == pytest.approx(1.91, rel=1e-3)


@pytest.mark.parametrize("modulus", WORDS)
@pytest.mark.sweep(every=2)
def test_a_counter_that_starts_over_has_the_turns_of_one_that_never_does(modulus, tmp_path):
    got = of(tmp_path, columns(60.0, modulus), modulus)
    assert_true(got)
    assert got[0].turns == math.floor(1.91 * 60.0) - 1  # the first is left out


def first_order(path):
    """Return estimate and frequency of the follower's first order in a run."""
    window = window_in(path)
    angle = roll_angle(window, window.section("rolls").section(ROLL))
    return estimates(angle, window.readings(SIGNAL), window, [1])[1]


def without_segments(path, folder, gone):
    """Return a copy of a run in ``folder`` that lacks these segments."""
    lost = [f"signals-{number:04d}.csv.gz" for number in gone]
    assert all((path / name).exists() for name in lost)
    return shutil.copytree(path, folder / path.name, ignore=lambda *_: lost)


GONE = pytest.mark.parametrize("gone", [(2,), (2, 3), (2, 4)], ids=["one", "two in a row", "two"])
"""Segments that lack: the first one begins where the roll turns faster, which nobody sees. From
the speeds around it the motion over the hole is then guessed wrong, by a turn or by a range of
the count; it counts for no turn, and no phase goes on over it that is not the roll's."""


def assert_as_without_holes(got, gone):
    left, frequency_Hz = got
    spans = [(SEGMENT_S * k, SEGMENT_S * (k + 1)) for k in range(6) if k + 1 not in gone]
    turns = sum(turns_until(to_s) - turns_until(from_s) for from_s, to_s in spans)
    assert left.low <= RIPPLE_N <= left.high
    assert left.amplitude == pytest.approx(RIPPLE_N, rel=0.01)
    assert frequency_Hz == pytest.approx(turns / (SEGMENT_S * len(spans)), rel=1e-3)
    assert left.turns == pytest.approx(turns, abs=2 * len(gone) + 1)


def turns_until(time_s):
    return RATE_Hz * (time_s + FASTER * max(time_s - FROM_S, 0.0))


@GONE
@pytest.mark.parametrize("modulus", WORDS)
def test_rows_that_lack_change_neither_size_nor_frequency(gone, modulus, tmp_path):
    found = columns(60.0, modulus, faster=FASTER)
    spans = [(SEGMENT_S * (number - 1), SEGMENT_S * number) for number in gone]
    assert_as_without_holes(of(tmp_path, without(found, *spans), modulus), gone)


@GONE
@pytest.mark.parametrize("modulus", WORDS)
@pytest.mark.sweep(every=15)  # beside the same rows in memory
def test_lost_segments_change_neither_size_nor_frequency(gone, modulus, tmp_path):
    found = columns(60.0, modulus, faster=FASTER)
    path = recorded(tmp_path, found, site_text=site_text(modulus), segment_s=SEGMENT_S)
    left = first_order(without_segments(path, tmp_path / "left", gone))
    assert_as_without_holes(left, gone)


@pytest.mark.parametrize("modulus", WORDS)
@pytest.mark.sweep(every=2)
def test_missed_ticks_of_a_fast_roll_do_not_fold_its_angle(modulus, tmp_path):
    """24.3 turns a second: three missed ticks are half a turn."""
    found = columns(30.0, modulus, rate_Hz=24.3)
    whole, _ = of(tmp_path / "whole", found, modulus)
    spans = [(at_s, at_s + 3.0 * CYCLE_S - 1e-6) for at_s in np.arange(1.0, 29.0, 0.35)]
    estimate, frequency_Hz = of(tmp_path, without(found, *spans), modulus)
    assert estimate.amplitude == pytest.approx(whole.amplitude, abs=0.02)
    assert estimate.amplitude == pytest.approx(RIPPLE_N, rel=0.02)  # of 8 samples a turn
    assert frequency_Hz == pytest.approx(24.3, rel=1e-4)


@pytest.mark.parametrize("modulus", WORDS)
@pytest.mark.sweep(every=2)
def test_readings_that_lack_beside_a_wrap_cost_no_turn(modulus, tmp_path):
    found = columns(30.0, modulus)
    wraps = np.flatnonzero(np.abs(np.diff(found[COUNT])) > 1.0)[1::2]
    found[COUNT][[*wraps, 1000, 2001, 2002]] = math.nan
    got = of(tmp_path, found, modulus)
    assert_true(got)
    assert got[0].turns == math.floor(1.91 * 30.0) - 1


@pytest.mark.parametrize("modulus", [None, 13.1072, 16.0])
def test_one_wrong_reading_costs_no_phase(modulus, tmp_path):
    found = columns(30.0, modulus)
    found[COUNT][2500] += 8.0
    assert_true(of(tmp_path, found, modulus))


@pytest.mark.parametrize("modulus", [None, 13.1072, 16.0])
def test_a_counter_that_is_set_anew_joins_what_was_before_and_after_by_size(modulus, tmp_path):
    found = columns(60.0, modulus)
    values, per_turn, _ = WORDS[modulus]
    again = found["time_s"] > 31.0
    found[COUNT][again] = (found[COUNT][again] + 4.5 * math.tau) % (values / per_turn * math.tau)
    assert_true(of(tmp_path, found, modulus))


def test_a_row_whose_stretches_are_joined_by_size_says_so(tmp_path):
    found = columns(40.0, 16.0)
    again = found["time_s"] >= 20.0
    found[COUNT][again] = (found[COUNT][again] + 4.5 * math.tau) % (16.0 * math.tau)
    path = recorded(tmp_path, found, site_text=site_text(16.0))
    for times, joined in (((0.0, 19.0), False), ((0.0, 40.0), True)):
        window = RunWindow(folder=path, from_s=times[0], to_s=times[1])
        (row,) = [r for r in compare(window, window).rows if (r.signal, r.roll) == (SIGNAL, ROLL)]
        assert any("joined by size" in text for text in row.labels) == joined


def test_a_roll_that_stood_keeps_its_phase_though_its_count_trembles(tmp_path):
    """At standstill the count goes to and fro by one: the angle does not creep."""
    found = columns(60.0, 16.0)
    time_s = found["time_s"]
    moves = np.clip(time_s, 0.0, 25.0) + np.clip(time_s - 35.0, 0.0, None)
    angle = math.tau * 1.91 * moves
    counts = np.floor(angle / math.tau * 4096) + np.random.default_rng(1).integers(
        0, 2, angle.size
    )
    found[COUNT] = (counts % 65536) * math.tau / 4096
    found[SIGNAL] = 60.0 + RIPPLE_N * np.cos(angle)
    estimate, _ = of(tmp_path, found, 16.0)
    assert estimate.amplitude == pytest.approx(RIPPLE_N, abs=0.02)


def test_a_counter_that_counts_down_has_the_same_turns(tmp_path):
    found = columns(60.0, 13.1072)
    found[COUNT] = 13.1072 * math.tau - found[COUNT]
    assert_true(of(tmp_path, found, 13.1072))


def facts_of(path):
    """Return what is said of a run."""
    return compare(RunWindow(folder=path), RunWindow(folder=path)).windows[0]


def skipped(seconds, missed):
    """Return a record in which the service missed so many ticks at 12 s and one at 25 s."""
    found = columns(seconds, None)
    tick = found["tick"].astype(int)
    keep = ~(((tick > 2400) & (tick <= 2400 + missed)) | (tick == 5000))
    found = {name: values[keep] for name, values in found.items()}
    found["periods_count"] = np.diff(tick[keep], prepend=-1).astype(float)
    found["missed_count"] = 7.0 + np.cumsum(found["periods_count"] - 1.0)  # 7 before the folder
    found["tick"] = np.arange(float(keep.sum()))  # ticks that were done
    return found


@pytest.fixture(scope="module")
def skipping(tmp_path_factory):
    """By number of ticks that were missed a run of 60 s."""

    @cache
    def made(missed):
        folder = tmp_path_factory.mktemp("skipping")
        return recorded(folder, skipped(60.0, missed), segment_s=SEGMENT_S)

    return made


@pytest.mark.parametrize("missed", [1, 3, 400])
@pytest.mark.parametrize("gone", [(), (4,), (4, 5)])
@pytest.mark.sweep(every=4)
def test_rows_that_lack_are_no_ticks_that_were_missed(missed, gone, skipping, tmp_path):
    """Lost segments lie beyond the ticks that were missed."""
    found = facts_of(without_segments(skipping(missed), tmp_path, gone))
    assert found.missed == missed + 1
    assert found.rows_lost == pytest.approx(len(gone) * SEGMENT_S / CYCLE_S, abs=60)
    assert bool(found.rows_lost) == bool(gone)


@pytest.mark.parametrize("lacks", [("missed_count",), ("missed_count", "tick")])
@pytest.mark.sweep(every=2)
def test_without_the_count_ticks_are_missed_by_the_periods_between_rows(lacks, tmp_path):
    found = skipped(60.0, 3)
    for name in lacks:
        del found[name]
    assert facts_of(recorded(tmp_path, found, segment_s=SEGMENT_S)).missed == 4


def test_a_tension_that_is_mostly_no_number_is_named_with_its_share(tmp_path):
    found = columns(40.0, 16.0)
    late = (found["time_s"] >= 20.0) & (np.arange(found["time_s"].size) % 5 < 3)
    found[SIGNAL][late] = math.nan  # three of five readings
    path = recorded(tmp_path / "runs", found, site_text=site_text(16.0), segment_s=SEGMENT_S)
    both = compare(RunWindow(folder=path, to_s=20.0), RunWindow(folder=path, from_s=20.0))
    said = f"{SIGNAL}: 60 % of its readings are no numbers: it is left out"
    assert [said in window.labels for window in both.windows] == [False, True]
    is_in_both = f"{SIGNAL} is recorded in both, but in one of them too few of its readings are"
    assert [text for text in both.labels if SIGNAL in text] == [f"{is_in_both} numbers"]
    assert all(row.signal != SIGNAL for row in both.rows)


def test_a_reading_that_is_no_number_is_as_a_missed_tick_and_many_are_a_hole(tmp_path):
    found = columns(30.0, None)
    found[SIGNAL][::50] = math.nan
    whole = of(tmp_path / "single", found, None)
    assert_true(whole)
    assert whole[0].turns >= math.floor(30.0 * 1.91) - 2
    found[SIGNAL][1000:1010] = math.nan
    holed = of(tmp_path / "hole", found, None)
    assert_true(holed)
    assert 1 <= whole[0].turns - holed[0].turns <= 2


@pytest.mark.parametrize(("gone", "is_hole"), [(3, False), (4, True)])
def test_four_cycles_are_bridged_and_five_are_a_hole_whatever_lacks(gone, is_hole, tmp_path):
    """Readings, counts or rows: of 26 samples a turn each is 4 at most apart, or a turn lacks.

    Every second reading beside them lacks too: the cycle is that of the rows all the same.
    """
    found = columns(10.0, None)
    rows = np.arange(found["time_s"].size)
    span = slice(1001, 1001 + gone)
    whole = math.floor(10.0 * 1.91) - 1
    for name in (SIGNAL, COUNT):
        lacks = found | {name: found[name].copy()}
        lacks[name][(rows % 2 == 1) & (rows > 200) & (rows < 1800)] = math.nan
        lacks[name][span] = math.nan
        turns = of(tmp_path / name, lacks, None)[0].turns
        assert (whole - turns > 0) == is_hole, name
    time_s = found["time_s"]
    less = without(found, (time_s[1001] - 1e-6, time_s[1001 + gone] - 1e-6))
    assert (whole - of(tmp_path, less, None)[0].turns > 0) == is_hole


@pytest.mark.parametrize(("lacks", "percent"), [(0.01, 0), (0.04, 4), (0.4, 40)])
def test_readings_that_are_bridged_are_told_by_their_share(lacks, percent, tmp_path):
    """Of two in a row; the 8 in a row of another channel are holes, and bridged by nobody."""
    found = columns(10.0, None)
    rows = np.arange(found["time_s"].size)
    period = round(2.0 / lacks)
    found[SIGNAL][(rows % period) < 2] = math.nan
    found["unwind_tension_N"][(rows % 40) < 8] = math.nan
    found["unwind_tension_N"][-1] = math.nan  # beyond the last one nothing is bridged
    path = recorded(tmp_path, found, site_text=site_text(None))
    said = [text for text in window_in(path).labels if "bridged" in text]
    expected = (
        f"{SIGNAL}: {percent} % of its readings are no numbers and bridged between their "
        "neighbours: its figures are of the others"
    )
    assert said == [expected] * (percent > 0)


def test_of_a_counter_that_starts_over_early_the_key_and_its_value_are_named(tmp_path):
    """64800 counts of a u16, 18 turns: each time the angle gains a fifth of a turn."""
    found = columns(10.0, None)
    turns = np.floor(8.0 * found["time_s"] * 3600.0) % 64800.0
    steps = (np.diff(turns) + 32768.0) % 65536.0 - 32768.0
    found[COUNT] = np.append(0.0, np.cumsum(steps)) * math.tau / 3600.0
    word = "u16, scale: 3600 counts/turn, wraps: true"
    path = recorded(tmp_path, found, site_text=site_text(None).replace(NEVER, word))
    (said,) = [text for text in window_in(path).labels if "starts over" in text]
    assert said == (
        f"{COUNT}: its count starts over after 64800 counts (seen 4 times), not after 65536, and "
        "the service loses its phase each time: write wraps_after: 64800"
    )


def test_readings_beyond_the_plausible_range_are_counted_in_a_label(tmp_path):
    found = columns(4.0, None)
    found[SIGNAL][[100, 300]] = 1e6, 0.5
    path = recorded(tmp_path, found)
    before, _ = compare(
        RunWindow(folder=path, to_s=2.0), RunWindow(folder=path, from_s=2.0)
    ).windows
    said = f"{SIGNAL}: 2 readings are not plausible by its site file (1 to 400 N): its figures are"
    assert [text.startswith(said) for text in before.labels if "plausible" in text] == [True]


def test_a_speed_that_is_no_number_is_no_standstill(tmp_path):
    found = columns(20.0, None)
    found["line_speed_m_s"][100::100] = math.nan
    path = recorded(tmp_path, found, segment_s=5.0)
    angle = roll_angle(window_in(path), Section({"radius_m": 0.1}))
    steps = found["time_s"].size - 1
    assert angle.angle_rad[-1] == pytest.approx(steps * CYCLE_S * 1.0 / 0.1, rel=1e-6)


def test_the_watch_says_what_share_of_the_readings_of_an_hour_is_bridged(tmp_path):
    found = columns(21.0, None)
    found[SIGNAL][::25] = math.nan
    run = run_hours(recorded(tmp_path, found, site_text=site_text(None)))
    said = run.read(run.hours[0])
    assert said.hour.stretch_s > 20.0
    assert [text.partition(" and ")[0] for text in said.lost] == [
        f"{SIGNAL}: 4 % of its readings are no numbers"
    ]


def test_web_is_counted_over_a_speed_that_is_no_number_where_a_segment_begins(tmp_path):
    found = columns(20.0, None)
    for begins in (1000, 2000, 3000):
        found["line_speed_m_s"][begins - 1 : begins + 2] = math.nan
    run = run_hours(recorded(tmp_path, found, segment_s=5.0))
    assert sum(map(run.web_m, run.hours)) == pytest.approx(20.0 * 1.0, rel=1e-3)
