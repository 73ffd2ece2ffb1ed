"""Sums over every tick against what the ticks were, and what no sum may claim."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import pi, tau

import numpy as np
import pytest

from aff_hmi.counts import Durations
from aff_hmi.layout import Layout
from aff_hmi.timing.tallies import Tallies
from aff_hmi.watch import News
from aff_runtime.app.report.line_facts import RollFacts
from aff_runtime.app.report.metrics.catalogue import BY_NAME
from aff_runtime.base.events import BY_NAME as EVENTS
from aff_runtime.base.signals import Outcome, State
from tests.aff_hmi.moments import LINE, facts, row, seen
from tests.doubles.virtual_clock import VirtualClock

SITE = replace(LINE, rolls=(*LINE.rolls, RollFacts(name="idler", radius_m=0.05)))
START_NS = 1_000


def tallies(**more: float) -> Tallies:
    clock = VirtualClock(1)
    clock.sleep_until_ns(START_NS)
    found = Tallies(clock)
    found.look(seen(row(**more), facts=facts(facts=SITE)), Layout())
    return found


def ticks(count: int, state: State = State.ACTIVE, **more: float) -> News:
    values = row(state, **more)
    records = np.tile(list(values.values()), (count, 1))
    return News(ring="r", columns=tuple(values), records=records)


def told(found: Tallies) -> dict[tuple[str, ...], float]:
    samples = list(found.samples())
    assert all(len(one.labels) == len(BY_NAME[one.metric].labels) for one in samples)
    return {(one.metric, *one.labels): one.value for one in samples}


def test_time_active_and_at_the_limit_is_ticks_times_the_cycle() -> None:
    found = tallies()
    found.listen(ticks(200))
    found.listen(ticks(40, limit_ratio_unwind_m_s=0.9))
    found.listen(ticks(60, State.BYPASS, limit_ratio_unwind_m_s=0.9))
    said = told(found)
    assert said["aff_active_seconds_total",] == pytest.approx(240 * 0.005)
    assert said["aff_correction_saturated_seconds_total", "unwind"] == pytest.approx(40 * 0.005)


def test_turns_and_web_are_those_of_the_angular_speed() -> None:
    found = tallies()
    of_rolls = {"unwind.omega_rad_s": -tau, "idler.omega_rad_s": 2 * tau}
    found.listen(ticks(1000, unwind_radius_m=0.25, **of_rolls))
    said = told(found)  # 5 s: 5 turns backwards of 0.25 m, 10 turns of 0.05 m
    assert said["aff_roll_turns_total", "unwind"] == pytest.approx(5.0)
    assert said["aff_web_meters_total", "unwind"] == pytest.approx(5 * tau * 0.25)
    assert said["aff_roll_turns_total", "idler"] == pytest.approx(10.0)
    assert said["aff_web_meters_total", "idler"] == pytest.approx(pi)


def test_what_a_silent_plc_said_last_turns_nothing() -> None:
    found = tallies()
    found.listen(ticks(100, age_s=0.081, **{"unwind.omega_rad_s": tau}))
    found.listen(ticks(100, **{"unwind.omega_rad_s": float("nan")}))
    assert told(found)["aff_roll_turns_total", "unwind"] == 0.0


def test_exchanges_are_counted_by_how_they_ended() -> None:
    found = tallies()
    found.listen(ticks(7))
    found.listen(ticks(2, outcome=float(Outcome.TIMEOUT)))
    said = told(found)
    assert said["aff_wire_exchanges_total", "ok"] == 7
    assert said["aff_wire_exchanges_total", "timeout"] == 2
    assert said["aff_wire_exchanges_total", "bad_reply"] == 0


def heard(found: Tallies, *events: Sequence[float]) -> dict[tuple[str, ...], float]:
    found.listen(News(ring="r", events=[tuple(one) for one in events]))
    return told(found)


def test_an_event_counts_once_and_none_from_before_the_screen() -> None:
    found, splice = tallies(), EVENTS["SPLICE"].code
    old, first, second = ((1, t_ns, splice, 0.0) for t_ns in (START_NS, 2_000, 3_000))
    assert heard(found, old, first)["aff_events_total", "SPLICE"] == 1
    said = heard(found, old, first, second, (9, 4_000, 250, 0.0))  # passed again with another ring
    assert said["aff_events_total", "SPLICE"] == 2
    assert said["aff_events_total", "BYPASSED"] == 0
    assert ("aff_events_total", "250") not in said


def test_what_a_line_was_in_ten_seconds_is_told_while_it_ticks() -> None:
    values = {"correction_unwind_m_s": -0.02, "unwind_tension_N": 88.0}
    said = told(tallies(**values))
    assert said["aff_correction_peak_meters_per_second", "unwind"] == pytest.approx(0.02)
    assert said["aff_tension_ripple_rms_newtons", "unwind_tension_N"] == 0.0
    assert ("aff_tension_ripple_rms_newtons", "tension_ref_N") not in said
    silent = told(tallies(**values, age_s=0.5))
    assert ("aff_correction_peak_meters_per_second", "unwind") in silent
    assert "aff_tension_ripple_rms_newtons" not in {name for name, *_ in silent}
    for gone in ({"writer_lives": False}, {"tick_age_s": 1.0}, {"tick_age_s": None}):
        found = tallies()
        found.look(seen(row(**values), facts=facts(facts=SITE), **gone), Layout())
        assert not [name for name, *_ in told(found) if "peak" in name or "ripple" in name]


def test_a_duration_is_in_the_class_whose_edge_it_reaches() -> None:
    found = Durations("aff_hmi_frame_delay_seconds", (0.01, 0.1))
    for time_s in (0.01, 0.011, 0.1, 5.0):
        found.add(time_s)
    histogram = found.histogram()
    assert [count for _, count in histogram.buckets] == [1.0, 3.0, 4.0]
    assert histogram.total == pytest.approx(5.121)
