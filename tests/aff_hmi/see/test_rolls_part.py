"""Rolls in mm, orders in dB, why one rests, and where orders of two rolls meet."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, replace

import pytest

from aff_hmi.see.rolls_part import FEWEST_ORDERS, STEP_DEG, RollPart, rolls_part
from aff_hmi.watch import Observed
from aff_hmi.words import say_in
from aff_runtime.app.report.line_facts import RollFacts
from aff_runtime.base.signals import State
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.phase import Source
from tests.aff_hmi.moments import LINE, facts, row, seen
from tests.each_case import each_case

SAY = say_in("en")
TURN = {"unwind.omega_rad_s": 5.0, "swrap.omega_rad_s": 16.0}
FIXED = replace(LINE, rolls=(*LINE.rolls, RollFacts(name="swrap", radius_m=0.0635)))


def order(name: str, number: int, mm: float, deg: float, **more: float) -> dict[str, float]:
    """Return the columns of one order."""
    values = {"shape_mm": mm, "phase_deg": deg, "state": float(OrderState.SETTLED)}
    values |= {"ripple_before": 2.0, "ripple": 0.02, "gain_of_P": 1.1, "share": 1.0}
    return {f"unwind.{name}_{number}x.{key}": v for key, v in (values | more).items()}


def moment(*orders: dict[str, float], **more: float) -> Observed:
    plain = {k: v for k, v in row().items() if not k.startswith("unwind.")}
    for one in orders:
        plain |= one
    return seen(plain | TURN | more, facts=facts(facts=FIXED))


def shown(*orders: dict[str, float], **more: float) -> RollPart:
    return rolls_part(moment(*orders, **more), SAY).rolls[0]


ECCENTRIC = [order("unwind", n, 0.6 if n == 1 else 0.0, 30.0) for n in (1, 2, 3)]


def test_an_eccentric_roll_is_drawn_as_a_cosine_with_its_high_place_where_it_is() -> None:
    roll = shown(*ECCENTRIC)
    for n, mm in enumerate(roll.outline_mm):
        at = math.radians(n * STEP_DEG)
        assert mm == pytest.approx(0.6 * math.cos(at + math.radians(30.0)), abs=6e-4)
    assert roll.extremes == "highest {high} at 330°, lowest {low} at 150°"
    assert (roll.high_mm, roll.low_mm) == (
        pytest.approx(0.6, abs=0.01),
        pytest.approx(-0.6, abs=0.01),
    )


def test_orders_add_up_to_one_outline() -> None:
    parts = ((1, 0.5, 40.0), (2, 0.3, -70.0), (5, 0.1, 10.0))
    roll = shown(*(order("unwind", n, mm, deg) for n, mm, deg in parts))
    at = math.radians(90.0)
    wanted = sum(mm * math.cos(n * at + math.radians(deg)) for n, mm, deg in parts)
    assert roll.outline_mm[90 // STEP_DEG] == pytest.approx(wanted, abs=6e-4)


def test_a_few_orders_or_unknown_ones_are_no_shape() -> None:
    few = [order("unwind", n, 0.5, 0.0) for n in range(1, FEWEST_ORDERS)]
    assert shown(*few).outline_mm == ()
    deaf = [order("unwind", n, math.nan, 0.0) for n in range(1, 9)]
    assert shown(*deaf).outline_mm == ()
    assert shown(*deaf).extremes.startswith("no shape is known")


def test_an_imbalance_is_a_torque_and_no_part_of_the_outline() -> None:
    torque = {k.replace("x_1x", "imbalance"): v for k, v in order("x", 1, 5.0, 0.0).items()}
    of_drive = replace(FIXED, outputs=(replace(FIXED.outputs[0], drive_roll="unwind"),))
    found = rolls_part(replace(moment(*ECCENTRIC, torque), facts=facts(facts=of_drive)), SAY)
    (roll,) = found.rolls
    assert max(roll.outline_mm) == pytest.approx(0.6, abs=1e-3)
    assert [(o.unit, o.size) for o in roll.orders if o.name == "imbalance"] == [("N m", 0.5)]


def test_zero_is_at_the_encoder_where_there_is_one_and_said() -> None:
    with_encoder = replace(
        FIXED, rolls=(replace(FIXED.rolls[0], angle_channel="unwind_angle_rad"), FIXED.rolls[1])
    )
    turned = {
        "unwind.source": float(Source.ENCODER),
        "unwind.theta_rad": 1.0,
        "unwind_angle_rad": 0.25,
    }
    found = replace(moment(*ECCENTRIC, **turned), facts=facts(facts=with_encoder))
    (roll,) = rolls_part(found, SAY).rolls
    assert "encoder reads zero" in roll.zero
    # theta of the service is 0.75 rad ahead of the encoder: the high place moves by as much
    assert roll.orders[0].deg == pytest.approx((30.0 + math.degrees(0.75)) % 360.0, abs=0.5)
    assert "began to count" in shown(*ECCENTRIC).zero


def test_an_order_tells_its_frequency_and_its_change_in_dB() -> None:
    (line,) = shown(order("unwind", 4, 0.1, -90.0, ripple_before=2.0, ripple=0.02)).orders
    assert line.frequency_Hz == pytest.approx(4 * 5.0 / math.tau, rel=1e-3)
    assert line.change_dB == pytest.approx(-40.0)
    assert (line.deg, line.out_percent, line.name) == (270.0, 100.0, "4×")


def test_what_is_not_known_is_none_and_never_zero() -> None:
    spoilt = dict.fromkeys(("ripple_before", "ripple", "gain_of_P", "shape_mm"), math.nan)
    (line,) = shown(
        order("unwind", 4, 0.1, 0.0, **spoilt), applied_ratio_unwind_m_s=math.nan
    ).orders
    assert (line.size, line.without, line.now, line.change_dB, line.ratio) == (None,) * 5
    assert line.out_percent is None
    (line,) = shown(order("unwind", 4, 0.1, 0.0, ripple=0.0)).orders
    assert line.change_dB is None


def test_what_rests_stands_first_with_its_reason() -> None:
    held = order("unwind", 3, 0.1, 0.0, state=float(OrderState.HELD_FREQUENCY))
    roll = shown(order("unwind", 1, 0.1, 0.0), order("unwind", 2, 0.1, 0.0), held)
    assert [line.name for line in roll.orders] == ["3×", "1×", "2×"]
    assert "too fast" in roll.orders[0].why
    assert roll.orders[1].why == ""


def test_crossings_are_where_the_frequencies_are_equal() -> None:
    roll = shown(
        *(order("unwind", n, 0.1, 0.0) for n in (1, 2, 3, 4)), order("swrap", 1, 0.1, 0.0)
    )
    met = {one.text: one.radius_mm for one in roll.crossings}
    # n / R = m / r: at 203 mm and below, 3x and 2x lie within reach, 1x far inside the core
    assert met == {"2× – swrap 1×": 127.0, "3× – swrap 1×": 190.5}
    assert [one.radius_mm for one in roll.crossings] == [190.5, 127.0]


def test_orders_of_a_fixed_roll_have_no_crossings_of_their_own() -> None:
    found = rolls_part(moment(order("unwind", 2, 0.1, 0.0), order("swrap", 1, 0.1, 0.0)), SAY)
    assert {r.roll: len(r.crossings) for r in found.rolls} == {"unwind": 1, "swrap": 0}


def test_without_ticks_or_facts_there_is_nothing() -> None:
    assert rolls_part(Observed(), SAY).rolls == ()
    assert rolls_part(replace(seen(), facts=None), SAY).rolls == ()
    assert rolls_part(seen(facts=facts(facts=None)), SAY).rolls == ()


def test_names_and_texts_of_others_are_made_printable() -> None:
    said = moment(order("un\u202ewind", 1, 0.1, 0.0))
    said = replace(said, facts=facts(facts=FIXED, shapes=("<b>\x1b" * 200,) * 50))
    part = rolls_part(said, SAY)
    text = json.dumps(asdict(part), ensure_ascii=False)
    assert "\x1b" not in text
    assert "\u202e" not in part.rolls[0].roll
    assert len(part.texts) <= 8


@each_case("state", list(State))
def test_every_moment_is_json_without_nan(state: State) -> None:
    spoilt = {key: math.nan for key in row() if "." in key or key.endswith(("_m", "_m_s"))}
    for more in ({}, spoilt):
        part = rolls_part(seen(row(state, **more)), SAY)
        json.dumps(asdict(part), allow_nan=False)
