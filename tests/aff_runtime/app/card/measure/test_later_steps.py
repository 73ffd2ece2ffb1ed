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


def test_orders_have_a_cost_and_none_may_be_held():
    found = orders.measure(evidence(blocks=(BLOCK,), state="ACTIVE"))
    assert figure(found, "cost").value == pytest.approx(4.0 / 2.0)  # mm/s over N
    assert figure(found, "cost").unit == "mm/s per N"
    assert figure(found, "reduction").value == 14.0
    assert found.verdict is Verdict.PASS
    held = replace(BLOCK, state="HELD phase", why="its response is not sure")
    bad = orders.measure(evidence(blocks=(BLOCK, held), state="ACTIVE"))
    assert (bad.verdict, figure(bad, "orders held").value) == (Verdict.FAIL, 1.0)
    assert "not sure" in bad.remarks[0]


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
