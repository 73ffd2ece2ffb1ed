"""Steps 8, 10 and 11: ripple that falls, orders that are held, trips that end in zero."""

import math
from dataclasses import replace

import numpy as np
import pytest

from aff_runtime.app.card.figures import Verdict
from aff_runtime.app.card.measure import orders, ripple, trips
from aff_runtime.app.report.block_status import BlockStatus
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.base.signals import State
from aff_runtime.config.loader import load_recorded_site
from tests.aff_runtime.app.card.measure.recorded import (
    CYCLE_S,
    SITE_FILE,
    evidence,
    figure,
    in_memory,
    recorded,
    steady,
    switched,
    window,
)

FAST = load_recorded_site(
    SITE_FILE.read_text()
    .replace("settle_s: 6", "settle_s: 4")
    .replace("settle_s: 10", "settle_s: 4")
    .replace("settle_s: 8", "settle_s: 4"),
    "site.yaml",
)


@pytest.mark.timeout(300)
def test_ripple_falls_within_three_settle_times_of_arming(abab_run):
    found = ripple.measure(evidence(window(abab_run[0], from_s=5.0), site=FAST))
    assert figure(found, "left to settle").value == 12.0
    order = figure(found, "pullroll_tension_N, swrap_follower 1x: reduction")
    assert order.value > 5.0
    assert found.verdict is Verdict.PASS
    course = next(one for one in found.samples if one.of.startswith("pullroll_tension_N"))
    times, sizes = np.array(course.rows).T
    before, after = sizes[times < 0.0].mean(), sizes[times > 12.0].mean()
    assert after < 0.6 * before


@pytest.mark.timeout(300)
def test_a_record_without_arming_or_too_short_after_it_is_open(abab_run):
    site = FAST
    off = ripple.measure(evidence(window(abab_run[0], to_s=28.0), site=site))
    assert "no arming" in off.missing[0]
    short = ripple.measure(evidence(window(abab_run[0], from_s=5.0, to_s=40.0), site=site))
    assert "stay armed for more than 12 s" in short.missing[0]
    assert {off.verdict, short.verdict} == {Verdict.OPEN}


@pytest.mark.parametrize(
    ("off_N", "left_N", "verdict", "waits_for"),
    [
        (1.9, 0.15, Verdict.PASS, ""),
        (1.9, 1.9, Verdict.OPEN, "fell by more than its error"),
        (0.0, 0.0, Verdict.OPEN, "stands out of the noise"),
        (0.15, 1.9, Verdict.FAIL, "fell by more than its error"),
        (0.0, 1.9, Verdict.FAIL, "fell by more than its error"),
    ],
)
@pytest.mark.sweep(every=2)
def test_a_first_ripple_passes_only_where_a_corrected_order_fell(
    tmp_path, off_N, left_N, verdict, waits_for
):
    columns, _ = switched(76.0, [(30.0, 76.0)], off_N, left_N)
    found = ripple.measure(evidence(window(recorded(tmp_path, columns)), site=FAST))
    assert found.verdict is verdict
    assert waits_for in "".join(found.missing)


BLOCK = BlockStatus(
    actuator="unwind", name="unwind 1x", roll="unwind", order=1, state="settled", why="",
    frequency_Hz=0.8, law="blocks", amplitude=0.004, unit="m/s", limit=0.02, out=1.0,
    phase_deg=10.0, encoder_deg=None, ripple_before=2.5, ripple=0.5, benefit_dB=14.0,
    ripple_unit="N", settle_s=6.0,
)  # fmt: skip


FOLLOWER = replace(
    BLOCK, actuator="swrap_follower", name="swrap_follower 1x", roll="swrap_follower"
)


def held(block, why="its response is not sure"):
    return replace(block, state="HELD phase", why=why)


def test_orders_have_a_cost():
    found = orders.measure(evidence(blocks=(BLOCK,), state="ACTIVE"))
    assert figure(found, "cost").value == pytest.approx(4.0 / 2.0)  # mm/s over N
    assert figure(found, "cost").unit == "mm/s per N"
    assert figure(found, "reduction").value == 14.0
    assert found.verdict is Verdict.PASS


def test_a_held_order_fails_by_the_ripple_that_it_leaves_and_is_listed_in_any_case(tmp_path):
    columns, _ = switched(26.0, [], off_N=0.4)
    seen = window(recorded(tmp_path, columns))
    silent = held(replace(BLOCK, name="unwind 2x", order=2))
    found = orders.measure(evidence(seen, blocks=(BLOCK, silent), state="ACTIVE"))
    of_silent = figure(found, "unwind 2x: held, its ripple (at most: in the noise)")
    # rms of a mean of 26 s at 5 ms, times sqrt(2) of an amplitude's power, times sqrt(ln 20)
    floor_N = 0.25 * 2.0 / math.sqrt(5200) * math.sqrt(math.log(20.0))
    assert of_silent.value == pytest.approx(floor_N, rel=0.4)
    assert (found.verdict, figure(found, "orders held").value) == (Verdict.PASS, 0.0)
    assert "unwind 2x: HELD phase, its response is not sure" in found.remarks[0]

    other = replace(FOLLOWER, name="swrap_follower 2x", order=2, ripple_before=19.0)
    loud = orders.measure(evidence(seen, blocks=(other, held(FOLLOWER)), state="ACTIVE"))
    left = figure(loud, "swrap_follower 1x: held, its ripple")
    assert (left.value, left.good) == (pytest.approx(0.4, rel=0.05), False)  # of 19 N: 2.1 %
    assert (loud.verdict, figure(loud, "orders held").value) == (Verdict.FAIL, 1.0)
    among_more = (replace(other, ripple_before=21.0), held(FOLLOWER))  # 0.4 N are 1.9 % of it
    assert (
        orders.measure(evidence(seen, blocks=among_more, state="ACTIVE")).verdict is Verdict.PASS
    )


def test_a_held_order_whose_ripple_was_not_seen_long_enough_keeps_the_step_open(tmp_path):
    seen = in_memory(tmp_path, steady(12.0))
    found = orders.measure(evidence(seen, blocks=(BLOCK, held(BLOCK)), state="ACTIVE"))
    assert found.verdict is Verdict.OPEN
    assert "20 are needed" in found.missing[0]
    unseen = orders.measure(evidence(blocks=(held(BLOCK),), state="ACTIVE"))
    assert (unseen.verdict, "does not show" in unseen.missing[0]) == (Verdict.OPEN, True)


def test_orders_without_a_correction_are_open():
    assert orders.measure(evidence(blocks=(BLOCK,), state="READY")).verdict is Verdict.OPEN
    assert orders.measure(evidence()).verdict is Verdict.OPEN


AT, FADE = 2000, 30  # tick of the cause; ticks until zero


def tripped(folder, change=None, back_after=None):
    columns = steady(20.0)
    rng = np.random.default_rng(1)
    count = columns["time_s"].size
    columns["unwind_tension_N"] += 0.1 * rng.standard_normal(count)
    columns["pullroll_tension_N"] += 0.1 * rng.standard_normal(count)
    columns["state"][: AT + 2] = State.ACTIVE
    columns["state"][AT + 2 :] = State.FADING
    columns["state"][AT + FADE :] = State.READY
    columns["status"][AT:] = 7.0
    columns["correction_unwind_m_s"][:] = 0.01
    columns["correction_unwind_m_s"][AT + FADE :] = 0.0
    if back_after is not None:
        columns["state"][AT + back_after :] = State.ACTIVE
    if change is not None:
        change(columns)
    return in_memory(folder, columns)


def trip(folder, *given, former=(), **how):
    return trips.measure(evidence(tripped(folder, **how), given=given, former=former))


def test_time_to_zero_is_from_the_cause_to_the_first_row_of_zero(tmp_path):
    found = trip(tmp_path, "trip=splice", back_after=400)
    time = figure(found, "splice: time to zero")
    assert time.value == pytest.approx(1e3 * FADE * CYCLE_S)
    assert time.high - time.value == pytest.approx(2e3 * CYCLE_S)
    assert figure(found, "splice: comes back").good is True
    assert figure(found, "splice: largest step").value < 5.0
    assert found.verdict is Verdict.OPEN  # seven other trips are missing
    assert len(found.missing) == len(trips.COMES_BACK) - 1


def test_of_two_trips_in_a_window_the_newest_is_measured(tmp_path):
    """The one before faded for a second and came back; the cable stays off."""

    def before(columns):
        columns["state"][400:600] = State.FADING
        columns["state"][600:800] = State.OFF
        columns["fresh"][AT - 16 :] = 0.0

    found = trip(tmp_path, "trip=cable", change=before)
    ticks = FADE + 17
    assert figure(found, "cable: time to zero").value == pytest.approx(1e3 * ticks * CYCLE_S)
    assert figure(found, "cable: stays off").good is True


def test_a_cable_is_timed_from_the_last_reading(tmp_path):
    def pull(columns):
        columns["fresh"][AT - 16 :] = 0.0

    found = trip(tmp_path, "trip=cable", change=pull)
    ticks = FADE + 17
    assert figure(found, "cable: time to zero").value == pytest.approx(1e3 * ticks * CYCLE_S)
    assert figure(found, "cable: stays off").good is True


def test_a_slow_fade_a_bump_and_a_wrong_return_fail(tmp_path):
    def slow(columns):
        columns["correction_unwind_m_s"][AT : AT + 100] = 0.01

    assert figure(trip(tmp_path / "a", "trip=bypass", change=slow), "time").good is False

    def jump(columns):
        columns["unwind_tension_N"][AT + 50 :] += 3.0

    bump = figure(trip(tmp_path / "b", "trip=bypass", change=jump), "largest step")
    assert bump.good is False
    back = trip(tmp_path / "c", "trip=bypass", back_after=1500)
    assert figure(back, "stays off").good is False


def test_a_step_is_measured_in_deviations_of_the_steps_before():
    rng = np.random.default_rng(2)
    before = rng.standard_normal(1000)
    expected = 10.0 / np.std(np.diff(before))
    assert trips.bump_sigmas(before, [0.0, 10.0, 10.0]) == pytest.approx(expected)
    assert math.isnan(trips.bump_sigmas([], []))


def test_all_trips_pass_together_and_the_last_of_each_counts(tmp_path):
    former = ()
    for name, back in trips.COMES_BACK.items():
        given = [f"trip={name}"]
        if name in trips.ENDS_RECORD:
            given.append("time=80 ms")
        back_after = 400 if back else None
        found = trip(tmp_path / name, *given, former=former, back_after=back_after)
        former = (*former, *found.samples)
    assert found.verdict is Verdict.PASS
    slow = trip(tmp_path / "again", "trip=kill", "time=0.5 s", former=former)
    assert slow.verdict is Verdict.FAIL


def test_what_was_not_typed_or_did_not_happen_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="type which"):
        trip(tmp_path / "a")
    with pytest.raises(ConfigError, match="type when the PLC shows zero"):
        trip(tmp_path / "b", "trip=kill")
    with pytest.raises(RefusedError, match="not tripped in it"):
        trips.measure(evidence(in_memory(tmp_path / "c", steady(9.0)), given=["trip=bypass"]))
