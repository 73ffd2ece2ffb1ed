"""When a correction acted; expected is lockstep's: sent a tick later, taken a scan after."""

import numpy as np
import pytest

from aff_runtime.base.signals import Outcome
from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.run_delivery import delivered, on_grid, sent_unseen
from tests.aff_runtime.app.card.measure.recorded import CYCLE_S, recorded, switched
from tests.each_case import each_case

ROWS = np.arange(40)
TICK = np.arange(1.0, 41.0)
SENT = np.round(0.01 * np.sin(0.3 * TICK), 5)
NAME = "unwind_m_s"


def columns(**more):
    return {"tick": TICK, f"correction_{NAME}": SENT} | more


def of(table, count=1e-5, delay_s=None, rows=ROWS):
    return delivered(table, NAME, rows, count=count, delay_s=delay_s, cycle_s=0.005)


def test_what_the_plc_says_it_adds_goes_before_all_else():
    applied = np.linspace(0.0, 0.01, 40)
    found = of(columns(plc_applied_unwind_m_s=applied, echo_age=np.ones(40)))
    assert found.values.tolist() == applied.tolist()
    assert found.known


@pytest.mark.parametrize("age", [1, 3])
def test_the_echo_says_which_command_acted(age):
    # the command of tick t carries what tick t - 1 decided
    found = of(columns(echo_age=np.full(40, float(age))))
    assert found.values[age + 1 :] == pytest.approx(SENT[: -(age + 1)])
    assert found.known


def test_an_applied_word_with_a_hole_is_not_taken():
    applied = np.zeros(40)
    applied[7] = np.nan
    found = of(columns(plc_applied_unwind_m_s=applied, echo_age=np.ones(40)))
    assert found.values[2:] == pytest.approx(SENT[:-2])


def test_without_either_the_usual_two_cycles_are_taken_and_said():
    found = of(columns())
    assert found.values[2:] == pytest.approx(SENT[:-2])
    assert not found.known
    assert found.how == "as sent, 2 cycles late (the usual delay)"


def test_the_site_files_own_delay_is_taken_where_it_has_one():
    # from a snapshot to its correction at the drive 25 ms: in the fifth cycle after the snapshot
    assert of(columns(), delay_s=0.025).values[4:] == pytest.approx(SENT[:-4])


def test_a_correction_is_what_its_word_can_hold():
    found = of(columns(), count=0.004)
    assert found.values[2:] == pytest.approx(np.rint(SENT[:-2] / 0.004) * 0.004)
    assert np.unique(np.abs(found.values)).size <= 3


def test_a_missed_tick_sent_nothing_new():
    keep = np.delete(np.arange(40), 20)
    table = {name: values[keep] for name, values in columns().items()}
    found = of(table, rows=np.arange(39))
    at = int(np.flatnonzero(table["tick"] == 23.0)[0])  # wants tick 21, which is not there
    assert found.values[at] == pytest.approx(SENT[19])


SCAN_S = 0.005
FIVE_SCANS = np.array([0.0, 1.0, 4.0]) * SCAN_S
ACTED = np.array([1.0, 2.0, 8.0])


def filled(unseen=(False, False, False), grid=None):
    grid = np.arange(5) * SCAN_S if grid is None else grid
    return on_grid(ACTED, FIVE_SCANS, grid, scan_s=SCAN_S, unseen=np.array(unseen)).tolist()


def test_scans_of_missed_ticks_take_what_the_next_row_shows():
    # nothing was sent between the second row and the third: one command for all scans after it
    assert filled() == [1.0, 2.0, 8.0, 8.0, 8.0]


def test_scans_in_which_another_command_may_have_come_lie_between_their_neighbours():
    assert filled((False, False, True)) == pytest.approx([1.0, 2.0, 4.0, 6.0, 8.0])


def test_within_its_scan_a_row_counts_and_after_the_last_one_too():
    grid = np.array([0.4, 1.9, 2.1, 4.5, 5.5]) * SCAN_S
    assert filled(grid=grid) == [1.0, 2.0, 8.0, 8.0, 8.0]


def exchanges(**more):
    """Return columns of eight good rows."""
    given = {"tick": np.arange(8.0), "outcome": np.full(8, float(Outcome.OK)), "fresh": np.ones(8)}
    return given | more


def test_an_exchange_that_failed_or_whose_row_is_lost_may_have_sent_what_no_row_shows():
    outcome = np.full(8, float(Outcome.OK))
    outcome[3] = float(Outcome.TIMEOUT)
    good = np.array([0, 1, 2, 4, 5, 6, 7])
    assert np.flatnonzero(sent_unseen(exchanges(outcome=outcome), good)).tolist() == [3]
    lost = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 7.0, 8.0])
    assert np.flatnonzero(sent_unseen(exchanges(tick=lost), np.arange(8))).tolist() == [5]


def test_an_exchange_that_showed_no_new_scan_was_before_those_that_are_missing():
    fresh = np.array([1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0])
    good = np.flatnonzero(fresh)
    assert not sent_unseen(exchanges(fresh=fresh), good).any()
    assert not sent_unseen(exchanges(), np.arange(8)).any()


@each_case(("age", "delay_s"), [(1, None), (3, None), (None, None), (None, 0.025)])
def test_rows_that_carry_what_was_decided_before_the_record_are_counted(age, delay_s):
    echo = {} if age is None else {"echo_age": np.full(40, float(age))}
    found = of(columns(**echo), delay_s=delay_s)
    # a command of the echo's age was decided a tick before it; else by the delay as taken
    late = age + 1 if age is not None else 2 if delay_s is None else 4
    assert found.unknown_first == late
    assert found.values[late:] == pytest.approx(SENT[:-late])
    later = of(columns(**echo), delay_s=delay_s, rows=np.arange(10, 40))
    assert later.unknown_first == 0


def test_after_a_hole_the_command_from_before_it_is_not_taken_for_the_newest():
    keep = np.concatenate([np.arange(15), np.arange(25, 40)])
    table = {name: values[keep] for name, values in columns().items()}
    found = of(table, rows=np.arange(15, 30))
    assert found.unknown_first == 2
    assert found.values[2:] == pytest.approx(SENT[25:38])


def test_a_correction_that_is_off_when_the_record_begins_was_off_before():
    sent = np.where(TICK < 10, 0.0, SENT)
    assert of(columns(correction_unwind_m_s=sent, echo_age=np.ones(40))).unknown_first == 0


@pytest.mark.parametrize("age", [2.0, -1.0])
@pytest.mark.sweep(every=2)
def test_a_part_of_a_long_run_has_the_corrections_of_the_whole(tmp_path, age):
    table, _ = switched(60.0, [(8.0, 55.0)])
    table["plc_applied_swrap_follower_m_s"] *= np.nan
    table["echo_age"] += age
    path, name = recorded(tmp_path, table), "correction_swrap_follower_m_s"
    whole = read_record(path).columns[name]
    part = read_record(f"{path}@20..50")
    assert part.run is not None
    first, end = (round(at_s / CYCLE_S) for at_s in (part.run.from_s, part.run.to_s))
    assert part.run.from_s == pytest.approx(20.0 + CYCLE_S * (3 if age > 0.0 else 2))
    assert np.all(whole[first : first + 4] != 0.0)
    assert part.columns[name].tolist() == whole[first : end + 1].tolist()
    off = read_record(f"{path}@2..30")
    assert off.run is not None
    assert off.run.from_s == pytest.approx(2.0)


def test_a_correction_that_is_no_number_is_as_a_tick_that_is_missing_and_said():
    spoilt = SENT.copy()
    spoilt[10:13] = np.nan
    found = of(columns(**{f"correction_{NAME}": spoilt}))
    expected = SENT.copy()
    expected[10:13] = SENT[9]
    assert found.values[2:] == pytest.approx(expected[:-2])
    assert found.how.endswith("; in 3 rows it is no number: the one before stands in")
    nothing = of(columns(**{f"correction_{NAME}": np.full(40, np.nan)}))
    assert not nothing.values.any()
    assert "in 40 rows it is no number" in nothing.how
