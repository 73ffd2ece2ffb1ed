"""Step 2: the heartbeat and whose rest it is; words against a display that was read before."""

import math

import numpy as np
import pytest

from aff_runtime.app.card.figures import Verdict
from aff_runtime.app.card.measure import words
from tests.aff_runtime.app.card.measure.recorded import (
    CYCLE_S,
    SITE,
    evidence,
    figure,
    in_memory,
    steady,
)

SHOWN = [
    "unwind_tension_N=88.44 N",
    "pullroll_tension_N=60 N",
    "line_speed_m_s=60 m/min",
    "unwind_radius_m=200 mm",
]


def test_words_are_compared_with_the_display_in_percent(tmp_path):
    found = words.measure(evidence(in_memory(tmp_path, steady(10.0)), given=SHOWN))
    tension = figure(found, "unwind_tension_N")
    assert tension.value == pytest.approx(100.0 * (88.0 - 88.44) / 88.44)
    assert figure(found, "line_speed_m_s").value == pytest.approx(0.0, abs=1e-9)
    assert found.verdict is Verdict.PASS
    part = words.measure(evidence(in_memory(tmp_path, steady(10.0)), given=SHOWN[:3]))
    assert part.verdict is Verdict.OPEN
    assert "unwind_radius_m" in part.missing[0]


@pytest.mark.parametrize(
    ("shown_m", "nearest_m"), [(0.2, 0.2003), (0.2084, 0.2084), (0.216, 0.2117), (0.196, 0.2003)]
)
def test_a_radius_that_shrinks_is_compared_where_the_display_was_read(
    tmp_path, shown_m, nearest_m
):
    """From 212 to 200 mm in the ten seconds: read in them at any moment, or never."""
    columns = steady(10.0)
    share = columns["time_s"] / columns["time_s"][-1]
    columns["unwind_radius_m"] = 0.212 - 0.012 * share
    given = [*SHOWN[:3], f"unwind_radius_m={shown_m} m"]
    found = words.measure(evidence(in_memory(tmp_path, columns), given=given))
    error = 100.0 * (nearest_m - shown_m) / shown_m
    assert figure(found, "unwind_radius_m").value == pytest.approx(error, abs=0.16)
    assert found.verdict is (Verdict.PASS if abs(error) < 1.0 else Verdict.FAIL)


def test_of_a_long_window_the_last_ten_seconds_of_a_radius_count(tmp_path):
    columns = steady(30.0)
    columns["unwind_radius_m"] = np.where(columns["time_s"] < 19.0, 0.21, 0.2)
    given = [*SHOWN[:3], "unwind_radius_m=0.21 m"]
    found = words.measure(evidence(in_memory(tmp_path, columns), given=given))
    assert figure(found, "unwind_radius_m").value == pytest.approx(-100.0 / 21.0)


def test_a_scale_that_is_off_by_two_percent_fails(tmp_path):
    columns = steady(10.0)
    columns["unwind_radius_m"] *= 1.02
    found = words.measure(evidence(in_memory(tmp_path, columns), given=SHOWN))
    assert figure(found, "unwind_radius_m").value == pytest.approx(2.0)
    assert found.verdict is Verdict.FAIL


def test_a_heartbeat_that_rests_and_an_echo_that_is_missing_fail(tmp_path):
    columns = steady(10.0)
    columns["plc_heartbeat"][400:404] = columns["plc_heartbeat"][399]
    columns["echo_age"][::4] = -1.0
    found = words.measure(evidence(in_memory(tmp_path, columns), given=SHOWN))
    rest = figure(found, "heartbeat: longest rest")
    assert rest.value == pytest.approx(1e3 * 5 * CYCLE_S)  # moves at 399 and at 404
    assert rest.good is False
    if SITE.gateway.read.aff_echo is not None:
        assert figure(found, "echo: share").value == pytest.approx(75.0)


def test_a_word_that_never_copies_our_heartbeat_is_no_echo(tmp_path):
    columns = steady(10.0)
    columns["echo_age"][:] = np.arange(columns["echo_age"].size)  # the word stands still
    found = words.measure(evidence(in_memory(tmp_path, columns), given=SHOWN))
    most = math.ceil(3 * SITE.freshness.fault_after_ms * 1e-3 / CYCLE_S) + 2
    share = figure(found, "echo: share")
    assert share.value == pytest.approx(100.0 * (most + 1) / columns["echo_age"].size)
    assert share.good is False


def rests(folder, ours, plc=0, late_us=0.0):
    """Return what is found of a heartbeat where ``ours`` ticks of the service are missing.

    Parameters
    ----------
    plc : ticks in which it rests otherwise. ``late_us`` : by how much a tick after 2 s wakes late,
        of three in which the heartbeat rests.
    """
    columns = steady(10.0)
    if plc:
        columns["plc_heartbeat"][1200 : 1200 + plc] = columns["plc_heartbeat"][1199]
    if late_us:
        columns["plc_heartbeat"][400:403] = columns["plc_heartbeat"][399]
        columns["wake_us"][401] = late_us
    kept = np.ones(columns["time_s"].size, dtype=bool)
    kept[800 : 800 + ours] = False
    columns = {name: values[kept] for name, values in columns.items()}
    return words.measure(evidence(in_memory(folder, columns), given=SHOWN))


def test_a_rest_in_which_our_own_ticks_are_missing_is_not_the_plcs(tmp_path):
    found = rests(tmp_path, ours=4)
    rest = figure(found, "heartbeat: longest rest")
    assert rest.value == pytest.approx(1e3 * 5 * CYCLE_S)
    assert rest.good is None
    assert found.verdict is Verdict.OPEN
    assert "up to 25 ms, the service missed or began late a tick" in found.missing[0]


def test_a_rest_in_which_our_own_tick_woke_late_is_not_the_plcs(tmp_path):
    assert rests(tmp_path / "a", ours=0, late_us=4000.0).verdict is Verdict.OPEN
    assert rests(tmp_path / "b", ours=0, late_us=400.0).verdict is Verdict.FAIL


def test_a_rest_of_the_plc_fails_though_ticks_of_ours_are_missing_elsewhere(tmp_path):
    assert rests(tmp_path / "a", ours=4, plc=4).verdict is Verdict.FAIL
    assert rests(tmp_path / "b", ours=1).verdict is Verdict.PASS


BEAT_S = 0.02


def beating(late_tick=None, missed_tick=None, missed_beat=None):
    """Return the rests of a PLC that beats every 20 ms, 1 ms after a tick, as 5 ms ticks read it.

    ``late_tick`` begins 4.5 ms late, ``missed_tick`` is not there, ``missed_beat`` does not come.
    """
    ticks = np.delete(np.arange(400), missed_tick if missed_tick is not None else [])
    wake_us = np.where(ticks == late_tick, 4500.0, 50.0)
    beats = np.floor((ticks * CYCLE_S + 1e-6 * wake_us - 0.001) / BEAT_S)
    beats = np.where(beats == missed_beat, beats - 1.0, beats)
    return words.longest_rest(ticks * CYCLE_S, beats, wake_us)


def test_a_beat_that_a_late_tick_sees_early_makes_no_rest_of_the_plcs_longer():
    assert CYCLE_S == 0.005
    assert beating().longest_s == pytest.approx(BEAT_S)
    # tick 200 is at 1.0 s, the beat at 1.001 s: in time it is seen at tick 201, late at 200
    rest = beating(late_tick=200)
    assert rest.longest_s == pytest.approx(BEAT_S + CYCLE_S)
    assert rest.seen_s == pytest.approx(BEAT_S)


def test_a_tick_that_is_missing_before_a_rest_makes_it_shorter_and_still_the_plcs():
    # the beat of 1.001 s is seen a tick later, that of 1.021 s does not come
    rest = beating(missed_tick=201, missed_beat=51)
    assert rest.longest_s == pytest.approx(2.0 * BEAT_S - CYCLE_S)
    assert rest.seen_s == pytest.approx(2.0 * BEAT_S - CYCLE_S)
