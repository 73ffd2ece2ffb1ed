"""The whole law against a lag-and-delay line with ripple of two rolls."""

import math
import random
from copy import deepcopy
from dataclasses import replace
from functools import cache

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import Permission
from aff_runtime.core.controller import Controller
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.params import BlockParams
from tests.aff_runtime.core.plants import (
    ACTUATOR,
    CYCLE_S,
    DARK,
    FREE,
    FROZEN,
    GRID_HZ,
    RIPPLE,
    LagDelay,
    Line,
    measured,
    rms,
    site,
    snapshot,
    with_blocks,
)
from tests.drawn import drawn


def plant():
    return LagDelay(-400.0, delay=12, lag=0.96)


def controller(*actuators, at=None):
    response = measured(at or plant().at, GRID_HZ)
    params = site(*actuators)
    return Controller(params, {a.name: response for a in params.actuators})


@cache
def _learned():
    line, law = Line(plant(), RIPPLE), controller()
    line.run(law, 20.0)
    return line, law


def learned():
    """Return a line and a law that has run on it for 20 s; a copy for each test."""
    return deepcopy(_learned())


def column(law, name):
    return law.telemetry()[law.telemetry_names().index(name)]


def test_speed_change_needs_no_new_learning_when_ripple_scales_with_speed():
    # plant without dynamics: required correction in m/s grows with speed
    flat = LagDelay(-300.0)
    line, law = Line(flat, RIPPLE), controller(at=flat.at)
    line.run(law, 25.0)
    line.omega = 10.0
    line.ripple = {key: 2 * c for key, c in RIPPLE.items()}
    line.run(law, 0.5, FROZEN)
    assert rms(line.run(law, 2.0, FROZEN)) < 0.05 * 2 * math.hypot(
        *(abs(c) for c in RIPPLE.values())
    )


def test_duplicate_samples_do_not_adapt():
    line, law = learned()
    before = column(law, "unwind.unwind_1x.phase_deg")
    line.run(law, 0.4, fresh=False)
    assert column(law, "unwind.unwind_1x.phase_deg") == before


def test_every_second_sample_a_duplicate_still_settles_on_time():
    line, law = Line(plant(), RIPPLE), controller()
    before = rms(line.run(law, 3.0, DARK))
    for _ in range(2000):
        for fresh in (True, False):
            line.run(law, CYCLE_S, fresh=fresh)
    assert rms(line.run(law, 3.0)) < 0.02 * before


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.sweep(every=3)  # all three in laws/test_catalogue.py
def test_a_bad_number_never_reaches_the_output(bad):
    line, law = learned()
    for channel in range(5):
        values = list(line.read())
        values[channel] = bad
        for _ in range(40):
            (step,) = law.step(snapshot(line.tick, *values), CYCLE_S, FREE)
            assert math.isfinite(step.value)
            assert math.isfinite(step.peak_bound)
            assert math.isfinite(step.slew_bound)
            line.advance(step.value)
    line.run(law, 20.0)
    assert rms(line.run(law, 2.0)) < 0.1


NUMBERS = st.sampled_from([math.nan, math.inf, 1e300, -1e300, 0.0]) | st.floats(-1e4, 1e4)


@drawn(quick=8, long=100)
@given(st.lists(st.tuples(*[NUMBERS] * 5, st.booleans(), st.integers(0, 2)), max_size=20))
def test_whatever_the_wire_says_the_output_is_finite_and_recovers(samples):
    line, law = Line(plant(), RIPPLE), controller()
    line.run(law, 1.0)
    for *values, fresh, roll_id in samples:
        read = snapshot(line.tick, *values, fresh=fresh, roll_id=roll_id)
        (step,) = law.step(read, CYCLE_S, FREE)
        assert math.isfinite(step.value)
        assert abs(step.value) <= step.peak_bound * (1 + 1e-9) <= 2 * 0.02 * (1 + 1e-6)
        assert math.isfinite(step.slew_bound)
        line.advance(step.value)
    line.run(law, 1.5, FROZEN)
    assert all(math.isfinite(column(law, f"unwind.unwind_{n}x.amplitude_m_s")) for n in (1, 2))


def test_limit_ratio_shortens_the_whole_vector_and_keeps_its_direction():
    line, law = learned()
    names = law.telemetry_names()
    before = dict(zip(names, law.telemetry(), strict=True))
    half = Permission(adapt=False, applied_ratio=(0.5,), limit_ratio=(0.5,))
    line.run(law, CYCLE_S, half)
    for n in (1, 2):
        key = f"unwind.unwind_{n}x."
        assert column(law, key + "amplitude_m_s") == pytest.approx(
            0.5 * before[key + "amplitude_m_s"], rel=1e-3
        )
        assert column(law, key + "phase_deg") == pytest.approx(before[key + "phase_deg"])


def test_a_block_stops_at_its_amplitude_limit_and_comes_back():
    blocks = BlockParams(roll="unwind", orders=(1,), settle_s=4.0, amp_limit=0.002)
    line, law = Line(plant(), {("unwind", 1): 3.0 + 0j}), controller(with_blocks(blocks))
    line.run(law, 20.0)
    assert column(law, "unwind.unwind_1x.amplitude_m_s") == pytest.approx(0.002, rel=0.01)
    assert column(law, "unwind.unwind_1x.state") == OrderState.CLAMPED
    line.ripple = {("unwind", 1): 0.3 + 0j}
    line.run(law, 12.0)
    assert rms(line.run(law, 2.0)) < 0.02


def test_slew_bound_covers_the_change_between_ticks():
    line, law = Line(plant(), RIPPLE), controller()
    last = 0.0
    for k in range(4000):
        if k == 2500:
            line.omega = 0.2  # below the threshold: the gate fades
        (step,) = law.step(snapshot(line.tick, *line.read()), CYCLE_S, FREE)
        if k > 5:
            assert abs(step.value - last) <= step.slew_bound * CYCLE_S * 1.1 + 2e-5
        last = step.value
        line.advance(step.value)


def test_output_fades_and_learning_stops_on_a_slow_line():
    line, law = learned()
    line.omega = 0.3
    line.run(law, 2.0)
    (step,) = law.step(snapshot(line.tick, *line.read()), CYCLE_S, FREE)
    assert step.value == step.peak_bound == 0.0
    assert column(law, "unwind.unwind_1x.state") == OrderState.IDLE


def test_order_above_the_limit_of_the_cycle_is_held_and_says_what_to_do():
    blocks = BlockParams(roll="unwind", orders=(13,), settle_s=4.0, amp_limit=0.01)
    line, law = Line(plant(), {}, omega=5.0), controller(with_blocks(blocks))
    line.run(law, 5.0)  # 10.3 Hz at 200 samples per second
    assert column(law, "unwind.unwind_13x.state") == OrderState.HELD_FREQUENCY
    found = law.arming_objections()["unwind"]
    said = "unwind_13x: 10.35 Hz is above the 10 Hz of the plain law at a cycle of 5 ms; "
    assert any(text.startswith(f"{said}shorten cycle_ms, run slower") for text in found), found


def test_an_order_that_only_the_stand_in_refuses_is_no_objection_before_a_first_probe():
    blocks = BlockParams(roll="unwind", orders=(13,), settle_s=4.0, amp_limit=0.01)
    waiting = replace(with_blocks(blocks), stands_in=True)
    line, law = Line(plant(), {}, omega=5.0), Controller(site(waiting), {})
    line.run(law, 0.1)
    assert law.arming_objections()["unwind"] == ("no measured response; run the probe",)
    probed = controller(waiting)
    line.run(probed, 0.1)
    (said,) = (text for text in probed.arming_objections()["unwind"] if "plain law" in text)
    assert "the plain law, which stands in, at a cycle of 5 ms; identify the drive" in said


def test_orders_of_a_roll_that_are_too_fast_are_one_objection_whatever_else_is_said_of_them():
    blocks = BlockParams(roll="unwind", orders=(1, 13, 14, 16), settle_s=4.0, amp_limit=0.01)
    line = Line(plant(), {}, omega=5.0)
    law = Controller(site(with_blocks(blocks)), {"unwind": measured(plant().at, [0.5, 1.0])})
    line.run(law, 5.0)
    (said,) = law.arming_objections()["unwind"]
    assert said.startswith("unwind_13x .. unwind_16x: 10.35 Hz is above the 10 Hz of")


def test_block_outside_the_probed_band_is_held():
    line = Line(plant(), RIPPLE)
    params = site()
    law = Controller(params, {"unwind": measured(plant().at, [4.0, 5.0])})
    line.run(law, 5.0)
    assert column(law, "unwind.unwind_1x.state") == OrderState.HELD_PHASE
    assert column(law, "unwind.unwind_1x.amplitude_m_s") == 0.0
    assert law.arming_objections()["unwind"]


def test_without_a_response_nothing_adapts_and_arming_is_refused():
    line, law = Line(plant(), RIPPLE), Controller(site(), {})
    line.run(law, 5.0)
    assert column(law, "unwind.unwind_1x.amplitude_m_s") == 0.0
    assert law.arming_objections()["unwind"] == ("no measured response; run the probe",)


def test_arming_is_allowed_in_the_probed_band():
    line, law = Line(plant(), RIPPLE), controller()
    line.run(law, 2.0, DARK)
    assert law.arming_objections() == {"unwind": ()}


def test_new_roll_id_resets_that_rolls_blocks_only():
    blocks = (
        BlockParams(roll="unwind", orders=(1,), settle_s=6.0, amp_limit=0.02),
        BlockParams(roll="swrap", orders=(1,), settle_s=6.0, amp_limit=0.02),
    )
    ripple = {("unwind", 1): 2.0 + 0j, ("swrap", 1): 1.0 + 0j}
    line, law = Line(plant(), ripple, swrap_omega=8.3), controller(with_blocks(*blocks))
    line.run(law, 15.0)
    kept = column(law, "unwind.swrap_1x.amplitude_m_s")
    line.run(law, CYCLE_S, FROZEN, roll_id=2)
    assert column(law, "unwind.unwind_1x.amplitude_m_s") == 0.0
    assert column(law, "unwind.swrap_1x.amplitude_m_s") == pytest.approx(kept, rel=0.01)


def test_orders_of_two_rolls_cross_without_divergence():
    blocks = (
        BlockParams(roll="unwind", orders=(1,), settle_s=3.0, amp_limit=0.05),
        BlockParams(roll="swrap", orders=(1,), settle_s=3.0, amp_limit=0.05),
    )
    ripple = {("unwind", 1): 2.0 + 0j, ("swrap", 1): 1.0j}
    line, law = Line(plant(), ripple, omega=6.2, swrap_omega=6.7), controller(with_blocks(*blocks))
    before = rms(line.run(law, 5.0, DARK))
    line.run(law, 12.0)
    worst = 0.0
    for _ in range(25):  # 6.2 -> 7.45 rad/s in 50 s, through 6.7
        line.omega += 0.05
        worst = max(worst, rms(line.run(law, 2.0)))
    assert worst < 0.25 * before
    line.run(law, 10.0)
    assert rms(line.run(law, 5.0)) < 0.05 * before


def test_slow_mean_stands_in_for_a_missing_reference():
    line, law = Line(plant(), RIPPLE), controller(replace(ACTUATOR, reference=None))
    before = rms(line.run(law, 3.0, DARK))
    line.run(law, 30.0)
    assert rms(line.run(law, 3.0)) < 0.03 * before


def test_retuning_goes_on_without_a_bump():
    line, law = learned()
    line.run(law, 5.0)
    faster = replace(ACTUATOR.blocks[0], settle_s=5.0, orders=(1, 2, 3))
    successor = controller(with_blocks(faster))
    successor.adopt(law)
    values = line.read()
    (a,) = law.step(snapshot(line.tick, *values), CYCLE_S, FROZEN)
    (b,) = successor.step(snapshot(line.tick, *values), CYCLE_S, FROZEN)
    assert b.value == pytest.approx(a.value, rel=1e-6)
    line.advance(b.value)
    assert rms(line.run(successor, 2.0)) < 0.03


def test_ripple_before_and_now_tell_success_from_harm():
    line, law = Line(plant(), RIPPLE), controller()
    line.run(law, 8.0, DARK)
    line.run(law, 25.0)
    ((before, now),) = law.ripple()
    assert before == pytest.approx(math.hypot(*(abs(c) for c in RIPPLE.values())), rel=0.1)
    assert now < 0.05 * before
    wrong = controller(at=lambda f: -plant().at(f))
    line = Line(plant(), RIPPLE)
    line.run(wrong, 8.0, DARK)
    line.run(wrong, 6.0)
    ((before, now),) = wrong.ripple()
    assert now > 1.5 * before
    assert column(wrong, "unwind.unwind_1x.state") == OrderState.RISING


def test_noise_leaves_the_cancelled_orders_near_the_floor():
    rng = random.Random(3)
    line, law = Line(plant(), RIPPLE, seed_noise=lambda: rng.gauss(0, 0.25)), controller()
    before = rms(line.run(law, 3.0, DARK))
    line.run(law, 25.0)
    assert rms(line.run(law, 5.0)) < 0.05 * before


def test_telemetry_has_one_name_per_number():
    law = controller()
    assert len(law.telemetry()) == len(law.telemetry_names()) == len(set(law.telemetry_names()))


def test_unknown_channel_or_roll_is_named():
    with pytest.raises(ConfigError, match="tensoin"):
        controller(replace(ACTUATOR, signal="tensoin"))
    with pytest.raises(ConfigError, match="rewind"):
        controller(with_blocks(BlockParams(roll="rewind", orders=(1,), settle_s=5, amp_limit=1)))


@pytest.mark.parametrize(("factor", "said"), [(-1.0, "counts against"), (2.0, "2.00 times")])
def test_a_roll_whose_encoder_is_scaled_wrong_does_not_arm(factor, said):
    """Learned on such an angle every order is another one: it would run, and help no web."""
    law = controller()
    for tick in range(600):
        theta = 5.0 * tick * CYCLE_S
        law.step(snapshot(tick, 90.0, 90.0, 1.0, factor * theta, theta), CYCLE_S, DARK)
    assert said in law.arming_objections()["unwind"][-1]
    right = controller()
    for tick in range(600):
        theta = 5.0 * tick * CYCLE_S
        right.step(snapshot(tick, 90.0, 90.0, 1.0, theta, theta), CYCLE_S, DARK)
    assert right.arming_objections()["unwind"] == ()
