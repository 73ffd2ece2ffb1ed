"""What a stretch says of each order: rows from a formula, with what a law says in them."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.app.report.comparison.window import window_of
from aff_runtime.app.report.parquet import table
from aff_runtime.app.report.watching import order_rows as module
from aff_runtime.app.report.watching import sentences
from aff_runtime.app.report.watching.findings import findings, unread
from aff_runtime.app.report.watching.order_rows import order_rows
from aff_runtime.app.report.watching.store import Store
from aff_runtime.app.report.watching.tables import ORDER_FIELDS, HourRow
from aff_runtime.base.runs.table import RunTable
from aff_runtime.base.runs.window import RunWindow
from aff_runtime.base.yaml_section import Section
from aff_runtime.core.monitor import OrderState
from tests.each_case import each_case

CYCLE_S, SECONDS, SPEED_M_S, RADIUS_M = 0.01, 60.0, 0.5, 0.05
TIME_S = np.arange(round(SECONDS / CYCLE_S)) * CYCLE_S
ONES = np.ones(TIME_S.size)
OMEGA = SPEED_M_S / RADIUS_M
SITE = """line: { name: Euclid }
gateway: { read: { channels: { a_tension_N: {}, tension_ref_N: {}, line_speed_m_s: {} } } }
rolls:
  roller: { radius_m: 5 cm }
  web: { radius: web_radius_m, resets_on: splice }
actuators:
  drive:
    error: { signal: a_tension_N, reference: tension_ref_N }
    limit_m_s: 0.1
    shape_limit_m: 15 mm
    blocks: [{ roll: roller, orders: [1, 2], settle_s: 4 s }]
"""
HOUR = HourRow(
    run_id="7",
    hour=3,
    time_utc=np.datetime64("2026-01-02", "us"),
    run="r",
    config_hash="c",
    speed_m_s=SPEED_M_S,
)


def rows(site=SITE, **columns):
    """Return rows by roll and order; ``columns`` beside a tension with 2 N once per turn."""
    swing = 2.0 * np.cos(OMEGA * TIME_S + 0.3)
    held = {"time_s": TIME_S, "line_speed_m_s": SPEED_M_S * ONES, "a_tension_N": 90.0 + swing}
    held |= {"tension_ref_N": 90.0 * ONES, "web_radius_m": 0.1 * ONES, "roll_id": 12.0 * ONES}
    made = RunTable(
        window=RunWindow(folder=Path("run")),
        about=Section(),
        columns=held | columns,
        site_text=site,
        events=(),
        lost=(),
    )
    return {(r.roll, r.order): r for r in order_rows(window_of(made), HOUR)}


def law(state, **columns):
    return {"drive.roller_1x.state": state * ONES} | {
        f"drive.roller_1x.{name}": value * ONES for name, value in columns.items()
    }


def test_a_roll_whose_number_lacks_in_the_last_row_is_the_roll_of_the_rows_before():
    lacks = np.where(TIME_S < 50.0, 12.0, 13.0)
    lacks[-3:] = math.nan
    assert {row.roll_id for row in rows(roll_id=lacks).values()} == {13}
    assert {row.roll_id for row in rows(roll_id=math.nan * ONES).values()} == {0}


def test_ripple_frequency_and_radius_are_those_of_the_record_and_set_points_are_no_signal():
    found = rows()
    assert set(found) == {("roller", 1), ("roller", 2), ("web", 1)}
    once = found["roller", 1]
    assert (once.signal, once.run_id, once.hour) == ("a_tension_N", "7", 3)
    assert once.ripple_N == pytest.approx(2.0, rel=0.01)
    assert once.frequency_Hz == pytest.approx(OMEGA / math.tau, rel=1e-3)
    assert once.radius_m == pytest.approx(RADIUS_M)
    assert found["roller", 2].ripple_N < 0.02
    assert all(math.isnan(v) for v in (once.shape_m, once.stroke_m, once.response_ratio))


def test_of_a_roll_that_turned_too_little_its_turns_are_kept_and_the_reason_is_told():
    columns = law(OrderState.SETTLED, amplitude_m_s=0.003)
    radius_m = SPEED_M_S * SECONDS / (5.5 * math.tau)  # 5.5 turns: 4 whole ones
    slow = rows(SITE.replace("5 cm", f"{radius_m} m"), **columns)
    once = slow["roller", 1]
    assert (once.turns, math.isnan(once.ripple_N), math.isnan(once.stroke_m)) == (4, True, True)
    made = Store(line="Euclid", orders=table(ORDER_FIELDS, list(slow.values())))
    assert findings(made) == []  # the roll of web has no life
    turn_s = SECONDS / 5.5
    assert list(sentences.unread(unread(made))) == [
        "roller: no line, 4 whole turns in its longest steady stretch, 8 are needed, "
        f"{10.0 * turn_s:.0f} s at one speed"
    ]
    said = json.loads(sentences.as_json("Euclid", [], unread=unread(made)))["without_a_line"]
    assert said == [
        {
            "roll": "roller",
            "turns": 4,
            "turns_needed": 8,
            "turn_s": pytest.approx(turn_s, rel=1e-3),
        }
    ]


def test_the_plain_laws_amplitude_is_a_stroke_over_its_angular_frequency():
    once = rows(**law(OrderState.SETTLED, amplitude_m_s=0.003))["roller", 1]
    assert once.stroke_m == pytest.approx(0.003 / OMEGA, rel=1e-3)
    assert once.limit_m == pytest.approx(0.1 / OMEGA, rel=1e-3)  # the actuator's: no amp_limit
    assert math.isnan(once.shape_m)


def test_the_limit_is_that_of_the_block_that_has_the_order():
    site = SITE.replace(
        "[{ roll: roller, orders: [1, 2], settle_s: 4 s }]",
        "[{ roll: roller, orders: [2], settle_s: 4, amp_limit_m_s: 0.02 }, "
        "{ roll: roller, orders: [1], settle_s: 4, amp_limit_m_s: 0.03 }]",
    )
    once = rows(site, **law(OrderState.SETTLED, amplitude_m_s=0.003))["roller", 1]
    assert once.limit_m == pytest.approx(0.03 / OMEGA, rel=1e-3)


def test_a_limit_of_law_shape_that_the_file_leaves_out_is_the_models_default():
    site = SITE.replace("    shape_limit_m: 15 mm\n", "")
    assert rows(site, **law(OrderState.SETTLED, shape_mm=0.25))["roller", 1].limit_m == 0.015


def test_law_shapes_deviation_and_response_ratio_are_taken_with_their_limit():
    once = rows(**law(OrderState.SETTLED, shape_mm=0.25, gain_of_P=0.8))["roller", 1]
    assert (once.shape_m, once.response_ratio) == pytest.approx((2.5e-4, 0.8))
    assert once.limit_m == pytest.approx(0.015)
    assert math.isnan(once.stroke_m)


def test_at_the_noise_an_order_is_settled_and_stalled_by_turns_and_still_learned():
    state = np.where(np.arange(TIME_S.size) % 5 < 3, OrderState.SETTLED, OrderState.STALLED)
    assert rows(**law(state, shape_mm=0.25))["roller", 1].shape_m == pytest.approx(2.5e-4)


def test_what_was_learned_in_the_first_half_counts_as_it_is_in_the_later_one():
    later = TIME_S >= 30.0
    state = np.where(later, OrderState.SETTLED, OrderState.IDLE)
    once = rows(**law(state, shape_mm=np.where(later, 0.25, 0.0)))["roller", 1]
    assert once.shape_m == pytest.approx(2.5e-4)


@each_case("at", [0.6, 0.9])
@each_case(
    "state",
    [
        OrderState.IDLE,
        OrderState.RISING,
        OrderState.HELD_PHASE,
        OrderState.HELD_FREQUENCY,
        OrderState.CLAMPED,
        77.0,
    ],
)
def test_a_law_that_was_held_or_at_a_limit_for_a_moment_has_no_size(state, at):
    states = OrderState.SETTLED * ONES
    states[round(at * TIME_S.size)] = state
    assert math.isnan(rows(**law(states, shape_mm=0.25))["roller", 1].shape_m)


def test_rows_of_no_known_speed_or_place_are_no_readings():
    for lacking in ({"speed_m_s": math.nan, "travelled_km": 1.0}, {}):
        known = [replace(row, **lacking) for row in rows().values()]
        assert findings(Store(line="Euclid", orders=table(ORDER_FIELDS, known))) == []


def test_an_order_that_is_learned_all_along_but_never_settled_has_no_size():
    assert math.isnan(rows(**law(OrderState.CONVERGING, shape_mm=0.25))["roller", 1].shape_m)


def test_web_is_marked_with_the_plcs_counter_and_has_no_trend():
    found = rows()
    assert (found["web", 1].is_roll, found["web", 1].roll_id) == (True, 12)
    assert not found["roller", 1].is_roll
    known = [replace(row, travelled_km=1.0) for row in found.values()]
    store = Store(line="Euclid", orders=table(ORDER_FIELDS, known))
    assert {one.readings.roll for one in findings(store)} == {"roller"}


@each_case("site", ["", "{", "rolls: 3\n", "rolls: { a: 3, b: {} }\nactuators: [1]\n"])
def test_a_site_file_that_says_no_rolls_gives_no_rows(site):
    assert rows(site) == {}


def test_a_site_file_with_a_great_many_rolls_is_bounded(monkeypatch):
    monkeypatch.setattr(module, "MOST_ROWS", 20)
    many = "".join(f"  r{k}: {{ radius_m: 0.05 }}\n" for k in range(30))
    assert len(rows(SITE.replace("rolls:\n", f"rolls:\n{many}"))) == 20
