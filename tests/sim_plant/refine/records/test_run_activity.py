"""Windows with AFF on, off, probing, at a limit, in shadow; ramps of the line."""

import numpy as np
import pytest

from aff_runtime.base.probe_columns import EXCITING
from aff_runtime.base.signals import State, StateBits
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.records.run_activity import activity_of, box_mean, ramps

STEP_S, ROWS = 0.01, 10_000
TIME_S = np.arange(ROWS) * STEP_S
SPEED = np.full(ROWS, 1.0)


def columns(**more):
    still = {"state": np.full(ROWS, float(State.ACTIVE)), "state_bits": np.zeros(ROWS)}
    return still | more


def at(first_s, last_s, value=1.0, other=0.0):
    return np.where((first_s <= TIME_S) & (last_s > TIME_S), value, other)


def test_on_off_and_probing_add_up_to_the_window():
    sent = at(20.0, 60.0, 0.01)
    probe = columns(**{"probe.stage": at(20.0, 45.0, EXCITING, np.nan)})
    found = activity_of(probe, [sent, np.zeros(ROWS)], SPEED, STEP_S)
    assert (found.off_s, found.probing_s, found.on_s) == pytest.approx((60.0, 25.0, 15.0))
    assert found.sentences()[0] == "AFF on 15 s, off 60 s, probing 25 s"


def test_an_aff_at_its_limit_is_named_with_what_the_record_holds():
    sent = at(0.0, 100.0, 0.05)
    bits = columns(state_bits=at(10.0, 14.0, float(StateBits.SATURATED)))
    ratio = columns(limit_ratio_unwind_m_s=at(10.0, 14.0, 0.8, 1.0))
    for told in (bits, ratio):
        found = activity_of(told, [sent], SPEED, STEP_S)
        assert found.saturated_s == pytest.approx(4.0)
        assert "AFF was at a limit for 4 s: the record holds what went out" in found.sentences()
    assert activity_of(bits, [np.zeros(ROWS)], SPEED, STEP_S).saturated_s == 0.0


def test_shadow_is_off():
    told = columns(state=at(0.0, 30.0, float(State.SHADOW), float(State.READY)))
    found = activity_of(told, [np.zeros(ROWS)], SPEED, STEP_S)
    assert (found.off_s, found.shadow_s) == pytest.approx((100.0, 30.0))
    assert "off in shadow, computed and not sent: 30 s of the time off" in found.sentences()


def test_shadow_in_which_something_acted_is_not_off():
    told = columns(state=at(0.0, 30.0, float(State.SHADOW), float(State.READY)))
    found = activity_of(told, [at(20.0, 40.0, 0.01)], SPEED, STEP_S)
    assert (found.off_s, found.on_s, found.shadow_s) == pytest.approx((80.0, 20.0, 20.0))


def test_a_ramp_is_where_the_speed_changes_and_ripple_is_none():
    speed = np.interp(TIME_S, [40.0, 44.0], [0.8, 1.2]) + 0.02 * np.sin(25.0 * TIME_S)
    found = np.flatnonzero(ramps(speed, STEP_S)) * STEP_S
    assert found.min() == pytest.approx(40.0, abs=1.0)  # half a second of mean and look each
    assert found.max() == pytest.approx(44.0, abs=1.0)
    assert not ramps(SPEED + 0.02 * np.sin(25.0 * TIME_S), STEP_S).any()


def test_a_ramp_is_told_with_what_its_length_includes():
    speed = np.interp(TIME_S, [40.0, 42.0], [0.8, 1.2])
    found = activity_of(columns(), [np.zeros(ROWS)], speed, STEP_S)
    assert 2.0 < found.ramp_s <= 2.0 + 2.0 * CRITERIA.records.run.ramp_look_s
    assert "up to 1 s before and after each ramp included" in found.sentences()[-1]


def test_the_box_mean_takes_what_there_is_at_the_ends():
    assert box_mean(np.array([1.0, 2.0, 6.0, 3.0]), 1).tolist() == [1.5, 3.0, 11.0 / 3.0, 4.5]
