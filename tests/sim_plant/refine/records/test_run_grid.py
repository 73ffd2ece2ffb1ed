"""Rows of a run on the PLC's own scans: what is expected follows from how the rows were made."""

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from aff_runtime.base.signals import Outcome, Status
from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.run_grid import angle_breaks, line_breaks, scans_of
from tests.aff_runtime.app.card.measure.recorded import recorded, switched
from tests.each_case import each_case

CYCLE_S = 0.005
RUNNING = float(Status.LINE_RUN | Status.WEB_INTACT)


def rows(scans, ticks=None, **more):
    """Return columns of rows that show these scans, at these ticks (one each when not given)."""
    ticks = np.arange(1, scans.size + 1, dtype=float) if ticks is None else ticks
    periods = np.concatenate(([1.0], np.diff(ticks)))
    fresh = np.concatenate(([1.0], (np.diff(scans) != 0).astype(float)))
    count = np.arange(1, scans.size + 1, dtype=float)
    columns = {
        "time_s": ticks * CYCLE_S,
        "tick": count,
        "periods_count": periods,
        "outcome": np.full(scans.size, float(Outcome.OK)),
        "fresh": fresh,
        "plc_heartbeat": np.mod(scans, 65536).astype(float),
        "status": np.full(scans.size, RUNNING),
        "roll_id": np.ones(scans.size),
    }
    return columns | more


def test_a_row_counts_at_the_scan_it_shows_however_late_it_was_made():
    scans = np.arange(100.0, 400.0)
    late = np.delete(scans, [50, 51])  # two ticks were missed
    found = scans_of(rows(late, ticks=late - 99.0), ())
    assert found.step_s == pytest.approx(CYCLE_S)
    assert found.taken_s == pytest.approx((late - 100.0) * CYCLE_S)
    assert found.findings == ("2 ticks were missed",)
    assert not found.breaks


def test_the_heartbeat_may_pass_the_end_of_its_word():
    scans = np.arange(65500.0, 65800.0)
    found = scans_of(rows(scans), ())
    assert found.taken_s == pytest.approx((scans - 65500.0) * CYCLE_S)
    assert not found.breaks


def test_a_row_that_shows_nothing_new_is_left_out():
    scans = np.arange(300.0)
    scans[60] = scans[59]  # the tick came just before the PLC's scan, the next just after it
    found = scans_of(rows(scans), ())
    assert 60 not in found.rows
    assert found.taken_s[60] == pytest.approx(61 * CYCLE_S)


def test_a_failed_exchange_and_a_reading_that_is_missing_are_no_samples():
    scans = np.arange(300.0)
    outcome = np.full(300, float(Outcome.OK))
    outcome[40] = Outcome.TIMEOUT
    tension = np.full(300, 90.0)
    tension[70] = np.nan
    found = scans_of(rows(scans, outcome=outcome, tension_N=tension), ["tension_N"])
    assert set(range(300)) - set(found.rows.tolist()) == {40, 70}
    assert found.findings[0] == "1 exchanges with the PLC failed"


def test_a_slow_plc_gives_one_sample_a_scan():
    ticks = np.arange(1.0, 801.0)
    found = scans_of(rows(np.floor(ticks / 4.0), ticks=ticks), ())
    assert found.step_s == pytest.approx(4 * CYCLE_S)
    assert found.scan_s == found.step_s
    assert found.rows.size == 201
    assert found.findings[-1] == "the PLC scans every 20 ms: one sample a scan"


def test_a_fast_plc_is_put_on_the_runs_cycle():
    ticks = np.arange(1.0, 801.0)
    found = scans_of(rows(np.floor(ticks * 2.5), ticks=ticks), ())
    assert found.step_s == pytest.approx(CYCLE_S)
    assert found.scan_s == pytest.approx(CYCLE_S / 2.5, rel=1e-3)
    assert found.taken_s[-1] == pytest.approx(799 * CYCLE_S, abs=0.002)


def free_running(scan_s, seconds):
    """Return rows that show the newest scan of a PLC with a clock of its own."""
    ticks = np.arange(1.0, round(seconds / CYCLE_S) + 1.0)
    return rows(np.floor(ticks * CYCLE_S / scan_s), ticks=ticks), ticks[-1] * CYCLE_S


@each_case("scan_s", [0.00504, 0.00496, 0.00503, 0.00998])
def test_a_plc_that_runs_free_keeps_its_own_time(scan_s):
    columns, to_s = free_running(scan_s, 120.0)
    found = scans_of(columns, ())
    span_s = to_s - columns["time_s"][0]
    assert found.taken_s[-1] == pytest.approx(span_s, rel=1e-4)
    assert found.scan_s == pytest.approx(scan_s, rel=1e-4)
    assert found.step_s == pytest.approx(CYCLE_S * round(scan_s / CYCLE_S))
    assert (
        f"the PLC scans every {1e3 * scan_s:.4g} ms: put on the run's cycle"
        in (found.findings[-1])
    )
    assert found.findings[-1].endswith("cycle times 2") == (scan_s > 0.009)
    assert not found.breaks


def test_a_plc_that_runs_free_leaves_out_no_sample(tmp_path):
    scans, _ = free_running(0.00504, 24.0)
    columns, _ = switched(24.0, [])
    for name in ("plc_heartbeat", "fresh"):
        columns[name] = scans[name]
    shown_s = scans["plc_heartbeat"] * 0.00504  # each row shows the tension of its scan
    columns["pullroll_tension_N"] = 60.0 + 3.0 * np.sin(2.0 * shown_s)
    record = read_record(recorded(tmp_path, columns))
    assert record.sample_time_s == pytest.approx(CYCLE_S)
    assert not any("missing samples" in text for text in record.findings)
    true_N = 60.0 + 3.0 * np.sin(2.0 * np.arange(record.samples) * CYCLE_S)
    np.testing.assert_allclose(record.columns["pullroll_tension_N"], true_N, atol=0.01)


@pytest.mark.parametrize(("off", "seconds"), [(3e-5, 300.0), (3e-4, 20.0)])
def test_what_two_crystals_or_a_short_window_do_not_tell_apart_is_one_clock(off, seconds):
    found = scans_of(free_running(CYCLE_S * (1.0 + off), seconds)[0], ())
    assert found.scan_s == found.step_s == pytest.approx(CYCLE_S)
    assert not any("scans every" in text for text in found.findings)


def test_an_outage_ends_a_piece_and_says_how_long_it_was():
    scans = np.concatenate((np.arange(0.0, 200.0), np.arange(300.0, 500.0)))
    found = scans_of(rows(scans, ticks=scans + 1.0), ())
    assert [(b.scan, b.why) for b in found.breaks] == [(200, "nothing was read for 0.505 s")]


def test_a_plc_that_starts_anew_ends_a_piece():
    scans = np.concatenate((np.arange(30000.0, 30200.0), np.arange(1.0, 201.0)))
    found = scans_of(rows(scans), ())
    assert [(b.scan, "started anew" in b.why) for b in found.breaks] == [(200, True)]
    assert found.taken_s[-1] == pytest.approx(399 * CYCLE_S)


def test_a_clock_that_goes_back_ends_a_piece():
    columns = rows(np.arange(400.0))
    columns["time_s"][200:] -= 0.6
    found = scans_of(columns, ())
    assert (200, "the clock of the run goes back") in [(b.scan, b.why) for b in found.breaks]
    assert found.taken_s[-1] == pytest.approx(399 * CYCLE_S)


def test_a_clock_that_jumps_forward_is_no_time_in_which_nothing_was_read():
    columns = rows(np.arange(400.0))
    columns["time_s"][200:] += 5.0
    found = scans_of(columns, ())
    assert [b.scan for b in found.breaks] == [200]
    assert found.breaks[0].why.startswith("the clock of the run jumps 5 s ahead, and neither")


def test_a_run_without_any_reading_is_refused():
    columns = rows(np.arange(300.0))
    columns["outcome"][:] = Outcome.NOT_CONNECTED
    with pytest.raises(PlantError, match="no row shows new readings of the PLC; give another"):
        scans_of(columns, ())


def test_a_column_without_a_number_is_named_where_no_row_can_be_used_for_it():
    columns = rows(np.arange(300.0))
    columns["periods_count"][:] = np.nan
    with pytest.raises(PlantError, match=r"\(periods_count: no number in any of them\)"):
        scans_of(columns, ())


@pytest.mark.parametrize("apart", [60, 200])
def test_rows_that_are_too_far_apart_to_count_scans_are_refused_as_that(apart):
    """At 0.3 s and 1 s from row to row: the clock goes on, and so does the heartbeat."""
    scans = np.arange(0.0, 300.0 * apart, apart)
    with pytest.raises(PlantError, match=r"no two rows within 0.25 s have a heartbeat that moves"):
        scans_of(rows(scans, ticks=scans + 1.0), ())


def test_splice_roll_and_stop_are_told_apart():
    columns = rows(np.arange(500.0))
    columns["status"][100:150] += float(Status.SPLICE_ACTIVE)
    columns["roll_id"][120:] = 2.0
    columns["status"][300:] -= float(Status.LINE_RUN)
    found = {b.scan: b.why for b in line_breaks(columns, np.arange(500))}
    assert found == {
        100: "a splice begins",
        150: "a splice ends",
        120: "another roll is on",
        300: "LINE_RUN goes",
    }


def test_a_roll_number_that_cannot_be_read_is_no_other_roll():
    columns = rows(np.arange(500.0))
    columns["roll_id"][300:] = 2.0
    columns["roll_id"][[100, 299, 300]] = np.nan
    found = line_breaks(columns, np.arange(500))
    assert [(b.scan, b.why) for b in found] == [(301, "another roll is on")]
    columns["roll_id"][:] = np.nan
    assert line_breaks(columns, np.arange(500)) == []


def test_an_angle_that_counts_anew_is_a_break_and_one_that_turns_is_none():
    taken = np.arange(400) * CYCLE_S
    angle = 5.0 * taken
    assert angle_breaks(angle, taken, "a_rad") == []
    angle[250:] -= 100.0
    assert [(b.scan, b.why) for b in angle_breaks(angle, taken, "a_rad")] == [
        (250, "a_rad counts anew")
    ]
