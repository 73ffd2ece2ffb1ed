"""Angles of runs that start over, with ticks and readings missing: the truth is a formula."""

import numpy as np
import pytest
import yaml

from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.run_angle import without_starts_over
from tests.aff_runtime.app.card.measure.recorded import CYCLE_S, SITE_FILE, recorded, switched

SECONDS = 24.0
ANGLE = "swrap_follower_angle_rad"
TURN = 2.0 * np.pi
RECORDED_ONLY = SITE_FILE.read_text().replace(
    "    angle: swrap_follower_angle_rad", "    #angle: swrap_follower_angle_rad"
)


def run(rate_rad_s, period_rad=TURN):
    """Return the columns of a run whose follower's counter starts over, and its true angle."""
    columns, _ = switched(SECONDS, [])
    truth = 1.0 + rate_rad_s * columns["time_s"]
    columns[ANGLE] = np.mod(truth, period_rad)
    return columns, truth


def without_rows(columns, gone):
    """Return the columns without these rows, as if their ticks had been missed."""
    kept = np.setdiff1d(np.arange(columns["time_s"].size), gone)
    found = {name: values[kept] for name, values in columns.items()}
    found["periods_count"] = np.concatenate(([1.0], np.diff(kept).astype(float)))
    found["tick"] = np.arange(kept.size, dtype=float)
    return found


def angle_of(folder, columns, site_text=None):
    record = read_record(recorded(folder, columns, site_text=site_text))
    assert record.duration_s == pytest.approx(SECONDS, abs=0.02)
    return record.columns[ANGLE]


def in_register(counts_per_turn, kind="u16"):
    """Return the site file with the follower's counter in such a register."""
    site = yaml.safe_load(SITE_FILE.read_text())
    channel = site["gateway"]["read"]["channels"][ANGLE]
    channel |= {"type": kind, "scale": f"{counts_per_turn} counts/turn", "wraps": True}
    return yaml.safe_dump(site)


@pytest.mark.parametrize("counts_per_turn", [1000, 2500, 3600, 4096, 5000, 100_000, 200_000])
@pytest.mark.sweep(every=3)
def test_a_register_that_holds_no_whole_turns_starts_over_where_it_ends(tmp_path, counts_per_turn):
    """Of 2500 counts per turn u16 holds 26.2 turns, of 100 000 it holds two thirds of one."""
    columns, truth = run(40.0, TURN * 65536 / counts_per_turn)
    gone = np.concatenate([np.arange(first, first + 3) for first in range(300, 4500, 381)])
    found = angle_of(tmp_path, without_rows(columns, gone), in_register(counts_per_turn))
    np.testing.assert_allclose(found, truth - truth[0], atol=1e-6)


@pytest.mark.parametrize("turns", [1, 3])
def test_a_plc_that_counts_turns_anew_in_such_a_register_is_told_by_its_steps(tmp_path, turns):
    columns, truth = run(-40.0, turns * TURN)
    record = read_record(recorded(tmp_path, columns, site_text=in_register(2500)))
    np.testing.assert_allclose(record.columns[ANGLE], truth - truth[0], atol=1e-6)
    (said,) = [text for text in record.findings if "wraps_after" in text]
    assert said.endswith(f"write wraps_after: {2500 * turns}")


@pytest.mark.parametrize("rate_rad_s", [160.0, -160.0, 6.0])
def test_no_turn_is_lost_where_ticks_are_missed(tmp_path, rate_rad_s):
    """Over five cycles a roll of 160 rad/s turns by 4 rad, more than half a turn."""
    columns, truth = run(rate_rad_s)
    gone = np.concatenate([np.arange(first, first + 4) for first in range(300, 4500, 381)])
    found = angle_of(tmp_path, without_rows(columns, gone))
    np.testing.assert_allclose(found, truth - truth[0], atol=1e-6)


def test_a_reading_that_is_missing_where_the_count_starts_over_is_filled_in_along_the_turn(
    tmp_path,
):
    columns, truth = run(10.0)
    over = np.flatnonzero(np.diff(columns[ANGLE]) < -np.pi)
    columns[ANGLE][over[::2]] = np.nan
    columns[ANGLE][over[1::2] + 1] = np.nan
    found = angle_of(tmp_path, columns, RECORDED_ONLY)
    np.testing.assert_allclose(found, truth - truth[0], atol=1e-6)


def test_a_roll_that_speeds_up_and_stops_keeps_its_turns():
    """A ramp over 10 s to 120 rad/s and down again; of fifty rows the last four are gone."""
    time_s = np.arange(6000) * CYCLE_S
    rate = np.interp(time_s, [2.0, 12.0, 18.0, 28.0], [0.0, 120.0, 120.0, 0.0])
    truth = np.cumsum(rate) * CYCLE_S
    kept = np.flatnonzero(np.arange(6000) % 50 < 46)
    count_rad = TURN / 1024
    read = np.floor(np.mod(truth, TURN) / count_rad)[kept] * count_rad
    found, said = without_starts_over({"a_rad": read}, time_s[kept], CYCLE_S)
    np.testing.assert_allclose(found["a_rad"], truth[kept], atol=1.01 * count_rad)
    # to the last turn, once each: a start over in a hole counts too
    assert said == [f"a_rad starts over {int(truth[-1] // TURN)} times: unwrapped"]


def test_a_counter_that_begins_anew_is_no_start_over():
    """It goes back by 5 turns and a third: no whole turns, so the step is left as it was read."""
    time_s = np.arange(2000) * CYCLE_S
    angle = 10.0 * time_s
    angle[1000:] -= 5.33 * TURN
    found, said = without_starts_over({"a_rad": angle}, time_s, CYCLE_S)
    assert found["a_rad"] is angle
    assert said == []


def test_one_wild_reading_shifts_nothing_after_it():
    time_s = np.arange(2000) * CYCLE_S
    truth = 10.0 * time_s
    read = np.mod(truth, TURN)
    read[777] += 2.5
    found, _ = without_starts_over({"a_rad": read}, time_s, CYCLE_S)
    beside = np.arange(2000) != 777
    np.testing.assert_allclose(found["a_rad"][beside], truth[beside], atol=1e-9)


def test_a_dancer_that_swings_stays_as_it_is():
    time_s = np.arange(4000) * CYCLE_S
    angle = 1.2 * np.sin(3.0 * time_s)
    found, said = without_starts_over({"dancer_rad": angle}, time_s, CYCLE_S)
    assert found["dancer_rad"] is angle
    assert said == []
