"""After a gap without readings a roll's angle goes on from its counter, or is known to be new."""

from __future__ import annotations

import math
from copy import deepcopy
from dataclasses import replace
from functools import cache

import pytest

from aff_runtime.core.controller import Controller
from aff_runtime.core.long_gap import CHANCE, NOISE_RAD, NOISE_S, STEADY_SPEED
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.params import BlockParams
from aff_runtime.core.phase import PREDICT_MAX_S, Quality, RollPhase, Source
from tests.aff_runtime.core.plants import (
    ACTUATOR,
    COUNT_RAD,
    CYCLE_S,
    DARK,
    FROZEN,
    LagDelay,
    Line,
    measured,
    rms,
    site,
)
from tests.aff_runtime.core.shape_site import DRIVE
from tests.aff_runtime.core.test_lost_angle import GRID_HZ, LosesAngle
from tests.aff_runtime.core.test_phase import INDEX, NAN, ROLL, encoder
from tests.each_case import each_case

RADIUS_M, OMEGA = 0.2, 5.0
CLOSE_RAD = 3.0 * COUNT_RAD
SHORT_WORD_RAD = 65536 * COUNT_RAD
BLOCKS = tuple(
    BlockParams(roll=roll, orders=(1,), settle_s=6.0, amp_limit=0.02)
    for roll in ("unwind", "swrap")
)
RIPPLE = {("unwind", 1): 2.0 + 1.0j, ("swrap", 1): 0.7j}


def word_of(turns):
    return lambda theta: math.remainder(encoder(theta), turns * math.tau)


short_word = word_of(16)


class Turning:
    """A roll with a gap in what is read of it."""

    def __init__(self, params=ROLL, read=encoder, start=0.0):
        self.phase = RollPhase(params, INDEX)
        self.theta, self.read = start, read

    def run(self, seconds, omega=OMEGA, *, fresh=True, speed=True):
        for _ in range(round(seconds / CYCLE_S)):
            self.theta += omega * CYCLE_S
            shown = omega * RADIUS_M if speed else NAN
            self.phase.step((self.read(self.theta), shown, NAN, RADIUS_M), CYCLE_S, fresh)

    def gap(self, *parts):
        for seconds, omega in parts:
            self.run(seconds, omega, fresh=False)
        assert self.phase.quality is Quality.LOST

    @property
    def frame_rad(self):
        return math.remainder(self.phase.theta_rad - self.theta, math.tau)


@each_case("speed", [True, False])
@each_case(
    "parts",
    [[(3.0, 0.9 * OMEGA)], [(5.0, 0.0)], [(1.0, OMEGA), (60.0, 0.0)], [(30.0, 1.1 * OMEGA)]],
)
def test_a_counter_that_went_on_keeps_the_frame(parts, speed):
    roll = Turning(start=1000.0)
    roll.run(2.0, speed=speed)
    before = roll.frame_rad
    roll.gap(*parts)
    roll.run(CYCLE_S, parts[-1][1], speed=speed)
    assert roll.frame_rad == pytest.approx(before, abs=CLOSE_RAD)
    assert roll.phase.source is Source.ENCODER
    roll.run(1.0, parts[-1][1], speed=speed)
    assert roll.frame_rad == pytest.approx(before, abs=CLOSE_RAD)
    assert roll.phase.omega_rad_s == pytest.approx(parts[-1][1], abs=0.05)
    assert roll.phase.origin_losses == 0


@each_case("start", [1000.0, -1000.0])
@each_case("omega", [OMEGA, -OMEGA])
def test_a_counter_that_began_anew_has_another_origin(start, omega):
    roll = Turning(start=start)
    roll.run(2.0, omega)
    roll.gap((3.0, omega))
    zero = roll.theta
    roll.read = lambda theta: encoder(theta - zero)
    losses = []
    for _ in range(100):
        roll.run(CYCLE_S, omega)
        losses.append(roll.phase.origin_lost)
    assert sum(losses) == roll.phase.origin_losses == 1
    assert roll.phase.source is Source.ENCODER
    assert roll.phase.quality is Quality.GOOD


def test_a_counter_that_can_have_wrapped_tells_nothing():
    params = replace(ROLL, angle_modulus_rad=SHORT_WORD_RAD)
    within, beyond = (Turning(params, short_word) for _ in range(2))
    for roll, seconds in ((within, 5.0), (beyond, 30.0)):
        roll.run(2.0)
        before = roll.frame_rad
        roll.gap((seconds, OMEGA))
        roll.run(1.0)
        lost = seconds * OMEGA > SHORT_WORD_RAD / 2.0
        assert roll.phase.origin_losses == int(lost)
        if not lost:
            assert roll.frame_rad == pytest.approx(before, abs=CLOSE_RAD)


@pytest.mark.parametrize("speed", [True, False])
@pytest.mark.parametrize(("seconds", "now"), [(1.0, 1.0), (2.0, 1.0), (3.5, 0.8), (2.0, 0.0)])
def test_a_short_counter_that_began_anew_is_seldom_taken_for_known(seconds, now, speed):
    params, places = replace(ROLL, angle_modulus_rad=SHORT_WORD_RAD), 60
    kept = 0
    for place in range(places):  # of the counter, evenly spread
        roll = Turning(params, short_word, start=place * SHORT_WORD_RAD / places)
        roll.run(0.2, 2.0 * OMEGA, speed=speed)
        roll.gap((seconds, 2.0 * now * OMEGA))
        zero = roll.theta
        roll.read = lambda theta, zero=zero: short_word(theta - zero)
        roll.run(0.2, 2.0 * now * OMEGA, speed=speed)
        assert roll.phase.quality is Quality.GOOD
        kept += roll.phase.origin_losses == 0
    assert kept <= CHANCE * places


def test_a_short_counter_tells_a_stop_where_what_it_may_have_gone_is_little_of_its_word():
    params = replace(ROLL, angle_modulus_rad=SHORT_WORD_RAD)
    slack_rad = NOISE_RAD + NOISE_S * OMEGA
    longest_s = (CHANCE * SHORT_WORD_RAD - 2.0 * slack_rad) / (STEADY_SPEED * OMEGA)
    assert longest_s > PREDICT_MAX_S
    for seconds, losses in ((longest_s - 0.05, 0), (longest_s + 0.05, 1)):
        roll = Turning(params, short_word)
        roll.run(2.0)
        before = roll.frame_rad
        roll.gap((seconds, 0.0))
        roll.run(1.0, 0.0)
        assert roll.phase.origin_losses == losses
        assert losses or roll.frame_rad == pytest.approx(before, abs=CLOSE_RAD)


@pytest.mark.parametrize("turns", [1, 2])
@pytest.mark.parametrize("offset_m_s", [0.0, 0.005, NAN])
@pytest.mark.parametrize("seconds", [0.6, 5.0, 300.0])
def test_a_word_of_a_turn_or_two_keeps_the_frame_of_a_line_that_stands(seconds, offset_m_s, turns):
    roll = Turning(replace(ROLL, angle_modulus_rad=turns * math.tau), word_of(turns), start=1.0)
    roll.run(2.0)
    roll.run(1.0, 0.0)
    before = roll.frame_rad
    roll.gap((seconds, 0.0))
    shown = (roll.read(roll.theta), offset_m_s, NAN, RADIUS_M)
    roll.phase.step(shown, CYCLE_S, True)
    assert roll.phase.source is Source.ENCODER
    roll.run(1.0)
    assert roll.frame_rad == pytest.approx(before, abs=CLOSE_RAD)
    assert roll.phase.origin_losses == 0


@each_case("omega", [OMEGA, -OMEGA])
@each_case("turns", [1, 2])
def test_a_word_of_a_turn_or_two_keeps_the_frame_of_a_line_that_runs_on_a_little(turns, omega):
    modulus_rad = turns * math.tau
    slack_rad = NOISE_RAD + NOISE_S * OMEGA
    spread = STEADY_SPEED - 1.0 / STEADY_SPEED
    longest_s = (CHANCE * modulus_rad - 2.0 * slack_rad) / (spread * OMEGA)
    assert longest_s > PREDICT_MAX_S + 0.1
    for seconds, losses in ((PREDICT_MAX_S + 0.1, 0), (longest_s - 0.1, 0), (longest_s + 0.1, 1)):
        roll = Turning(replace(ROLL, angle_modulus_rad=modulus_rad), word_of(turns), start=3.0)
        roll.run(2.0, omega)
        before = roll.frame_rad
        roll.gap((seconds, omega))
        roll.run(1.0, omega)
        assert roll.phase.origin_losses == losses
        assert losses or roll.frame_rad == pytest.approx(before, abs=CLOSE_RAD)


@pytest.mark.parametrize("turns", [1, 2])
@pytest.mark.parametrize(("seconds", "omega"), [(0.6, OMEGA), (2.0, OMEGA), (60.0, 0.0)])
@pytest.mark.sweep(every=5)
def test_a_word_of_a_turn_or_two_that_began_anew_is_seldom_taken_for_known(seconds, omega, turns):
    params, places = replace(ROLL, angle_modulus_rad=turns * math.tau), 60
    read, kept = word_of(turns), 0
    for place in range(places):  # of the counter, evenly spread
        roll = Turning(params, read, start=(place + 0.5) * turns * math.tau / places)
        roll.run(0.2, omega)
        roll.gap((seconds, omega))
        zero = roll.theta
        roll.read = lambda theta, zero=zero: read(theta - zero)
        roll.run(0.2, omega)
        assert roll.phase.quality is Quality.GOOD
        kept += roll.phase.origin_losses == 0
    assert kept <= CHANCE * places + 1  # of a range that ends between two places


@each_case("gap_s", [0.1, 0.2, 0.3, 0.45])
@each_case("omega", [5.0 * OMEGA, -5.0 * OMEGA])
def test_a_word_of_one_turn_is_unfolded_about_the_way_of_a_short_gap(omega, gap_s):
    """In 0.3 s the roll turns 7.2 rad, more than half the range, and slows down meanwhile."""
    params = replace(ROLL, angle_modulus_rad=math.tau)
    roll = Turning(params, word_of(1), start=3.0)
    roll.run(3.0, omega)
    before, later = roll.frame_rad, 0.95 * omega
    roll.run(gap_s, later, fresh=False)
    roll.run(1.0, later)
    assert roll.phase.origin_losses == 0
    assert roll.frame_rad == pytest.approx(before, abs=CLOSE_RAD)


def test_a_word_that_wraps_within_a_turn_tells_nothing_where_it_can_have_wrapped():
    half = replace(ROLL, angle_modulus_rad=math.pi)
    for seconds, omega, losses in ((2.0, 0.0, 0), (2.0, OMEGA, 1)):
        roll = Turning(half, word_of(0.5), start=1.0)
        roll.run(2.0, omega)
        roll.gap((seconds, omega))
        roll.run(1.0, omega)
        assert roll.phase.origin_losses == losses


@pytest.mark.parametrize(("gap_s", "later_s"), [(0.3, 0.1), (0.3, 0.3), (3.0, 0.1)])
def test_other_settings_bring_no_lost_origin_back(gap_s, later_s):
    roll = Turning(start=1000.0)
    roll.run(2.0)
    roll.run(gap_s, fresh=False)
    edited = RollPhase(replace(ROLL, radius_max_m=0.6), INDEX)
    edited.follow(roll.phase)
    roll.phase = edited
    roll.run(later_s, fresh=False)
    is_lost = gap_s + later_s > PREDICT_MAX_S
    assert roll.phase.quality is (Quality.LOST if is_lost else Quality.PREDICTED)
    roll.run(1.0)
    assert roll.phase.quality is Quality.GOOD
    assert roll.phase.origin_losses == int(is_lost)


def test_a_roll_without_an_encoder_has_another_origin_after_a_gap():
    roll = Turning(replace(ROLL, angle=None))
    roll.run(2.0)
    assert roll.phase.origin_losses == 0
    roll.gap((3.0, OMEGA))
    roll.run(1.0)
    assert roll.phase.origin_losses == 1


def test_a_start_a_short_gap_and_a_new_roll_lose_no_origin():
    roll = Turning()
    roll.run(1.0)
    roll.run(0.3, fresh=False)
    roll.run(1.0)
    roll.phase.restart()
    roll.run(1.0)
    assert roll.phase.origin_losses == 0


def test_a_stuck_encoder_stays_out_over_a_gap():
    roll = Turning()
    roll.run(1.0)
    at = roll.theta
    roll.read = lambda _: encoder(at)
    roll.run(5.0)
    assert roll.phase.source is Source.ROLL_SPEED
    roll.gap((3.0, OMEGA))
    roll.run(1.0)
    assert roll.phase.source is Source.ROLL_SPEED
    assert roll.phase.origin_losses == 1
    assert math.isfinite(roll.phase.theta_rad)


# the iterative law is blocks that adapt in another way: what a gap does to both is the bank's
LAWS = ("blocks", pytest.param("iterative", marks=pytest.mark.long), "shape")


class Restarted(Line):
    """The unwind's counter counts from where it was ``zeroed``."""

    zero = 0.0

    def read(self):
        values = list(super().read())
        values[3] = encoder(self.theta - self.zero)
        return tuple(values)


def made(law):
    line, controller = law_on(Restarted, law)
    line.run(controller, 25.0)
    return line, controller


made_once = cache(made)


def learned(law):
    """Return a line and a law that has run on it for 25 s; a copy, but of compiled arithmetic."""
    return made(law) if law == "shape" else deepcopy(made_once(law))


def law_on(line_type, law):
    plant = LagDelay(-400.0, delay=12, lag=0.96)
    params = site(replace(ACTUATOR, law=law, drive=DRIVE, blocks=BLOCKS))
    line = line_type(plant, RIPPLE)
    line.theta += 1000.0
    return line, Controller(params, {"unwind": measured(plant.at, GRID_HZ)})


@pytest.mark.parametrize("law", LAWS)
def test_what_was_learned_at_an_origin_that_is_lost_is_not_sent(law):
    line, controller = learned(law)
    line.omega = 4.0
    line.run(controller, 3.0, DARK, fresh=False)
    line.zero = line.theta
    line.run(controller, 1.0, DARK)
    alone = math.sqrt(sum(abs(c) ** 2 for c in RIPPLE.values()) / 2.0)
    assert rms(line.run(controller, 3.0 * math.tau / 4.0, FROZEN)) < 1.05 * alone
    line.run(controller, 25.0)
    assert rms(line.run(controller, 3.0)) < 0.1 * alone


@pytest.mark.parametrize("law", LAWS)
def test_what_was_learned_is_kept_where_the_counter_went_on(law):
    line, controller = learned(law)
    line.run(controller, 5.0)
    line.omega, line.swrap_omega = 4.5, 6.03
    line.run(controller, 3.0, DARK, fresh=False)
    line.run(controller, 1.0, DARK)
    # the plant answers 4.5 rad/s a little differently; not as at another angle
    alone = math.sqrt(sum(abs(c) ** 2 for c in RIPPLE.values()) / 2.0)
    assert rms(line.run(controller, math.tau / 4.5)) < 0.4 * alone


def test_a_roll_that_is_exchanged_while_its_angle_is_lost_is_learned_anew():
    line, controller = law_on(LosesAngle, "shape")
    params = replace(controller.site.rolls[0], line_speed=None)
    params = replace(controller.site, rolls=(params, *controller.site.rolls[1:]))
    controller = Controller(params, controller.responses)
    line.run(controller, 20.0)
    line.lost = True
    line.run(controller, 2.0)
    line.run(controller, 1.0, roll_id=2)
    line.lost = False
    line.run(controller, 25.0, roll_id=2)
    states = {order.name: order for order in controller.order_statuses()}
    assert states["unwind_1x"].share == 1.0
    assert states["unwind_1x"].state is OrderState.SETTLED
