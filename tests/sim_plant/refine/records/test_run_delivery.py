"""When a correction acted; expected is lockstep's: sent a tick later, taken a scan after."""

import numpy as np
import pytest

from sim_plant.refine.records.run_delivery import delivered

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
