"""Every law of the catalogue keeps the rules of a law, on a lag-and-delay line with two orders.

The shape law learns through a drive and the plain law stands in for it here: its own tests are in
`core/shape`.
"""

import math
from copy import deepcopy
from dataclasses import replace
from functools import cache

import pytest

from aff_runtime.base.signals import Permission
from aff_runtime.core.controller import Controller
from aff_runtime.core.laws.catalogue import LAW_ROWS
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
)

HALF = Permission(adapt=True, applied_ratio=(1.0,), limit_ratio=(0.5,))
BLOCK = ACTUATOR.blocks[0]
LEARNED_S = 20.0
WORDS = sorted(set(LAW_ROWS) - {"shape"})


def plant():
    return LagDelay(-400.0, delay=12, lag=0.96)


def law_of(word, **block):
    actuator = replace(ACTUATOR, law=word, blocks=(replace(BLOCK, **block),))
    return Controller(site(actuator), {"unwind": measured(plant().at, GRID_HZ)})


@cache
def _learned(word):
    line, law = Line(plant(), RIPPLE), law_of(word)
    line.run(law, LEARNED_S)
    return line, law


def learned(word):
    """Return a line and a law that has run on it for `LEARNED_S`; a copy for each test."""
    return deepcopy(_learned(word))


def amplitude(law, order):
    name = f"unwind.unwind_{order}x.amplitude_m_s"
    return law.telemetry()[law.telemetry_names().index(name)]


@pytest.fixture(params=WORDS)
def word(request):
    return request.param


def test_ripple_falls_by_forty_decibels_and_by_the_weight_that_cancels(word):
    line, law = learned(word)
    line.run(law, 8.0)
    alone = math.sqrt(sum(abs(c) ** 2 for c in RIPPLE.values()) / 2.0)
    assert rms(line.run(law, 3.0)) < 0.01 * alone
    for (_, n), ripple in RIPPLE.items():
        wanted = abs(ripple / plant().at(n * line.omega / math.tau))
        assert amplitude(law, n) == pytest.approx(wanted, rel=0.02)


def test_nothing_is_learned_without_permission(word):
    line, law = Line(plant(), RIPPLE), law_of(word)
    line.run(law, 8.0, DARK)
    assert amplitude(law, 1) == amplitude(law, 2) == 0.0
    line.run(law, 6.0)
    learned = amplitude(law, 1)
    assert learned > 0.0
    line.run(law, 4.0, FROZEN)
    assert amplitude(law, 1) == pytest.approx(learned, rel=1e-3)  # the speed as counts tell it


def test_the_output_keeps_its_own_bounds(word):
    line, law, last = Line(plant(), RIPPLE), law_of(word, settle_s=4.0), 0.0
    for k in range(3000):
        permission = HALF if 1000 <= k < 1010 else FREE
        (step,) = law.step(snapshot(line.tick, *line.read()), CYCLE_S, permission)
        assert abs(step.value) <= step.peak_bound + 1e-12
        if k > 5 and permission is FREE:
            assert abs(step.value - last) <= step.slew_bound * CYCLE_S * 1.1 + 2e-5
        last = step.value
        line.advance(step.value)


def test_a_limit_in_force_halves_the_weights_and_they_come_back(word):
    line, law = learned(word)
    line.run(law, 25.0 - LEARNED_S)
    before = amplitude(law, 1)
    line.run(law, CYCLE_S, HALF)
    assert amplitude(law, 1) == pytest.approx(0.5 * before, rel=0.02)
    line.run(law, 25.0)
    assert amplitude(law, 1) == pytest.approx(before, rel=0.02)


def test_an_order_stops_at_its_amplitude_limit_and_comes_back(word):
    line, law = Line(plant(), {("unwind", 1): 3.0}), law_of(word, amp_limit=0.002, settle_s=4.0)
    line.run(law, 12.0)
    assert amplitude(law, 1) == pytest.approx(0.002, rel=0.01)
    line.ripple = {("unwind", 1): 0.3j}
    line.run(law, 20.0)
    assert rms(line.run(law, 2.0)) < 0.03


@pytest.mark.parametrize("other", WORDS)
def test_one_law_goes_on_where_another_stood(word, other):
    line, law = learned(other)
    (before,) = law.step(snapshot(line.tick, *line.read()), CYCLE_S, FREE)
    line.advance(before.value)
    new = law_of(word)
    new.adopt(law)
    (after,) = new.step(snapshot(line.tick, *line.read()), CYCLE_S, FREE)
    assert abs(after.value - before.value) <= before.slew_bound * CYCLE_S * 1.1 + 2e-5
    line.advance(after.value)
    assert rms(line.run(new, 6.0)) < 0.05


def test_what_is_learned_of_a_roll_goes_with_it(word):
    line, law = learned(word)
    line.run(law, CYCLE_S, FROZEN, roll_id=2)
    assert amplitude(law, 1) == amplitude(law, 2) == 0.0


def test_numbers_that_are_none_and_samples_that_are_missed_do_no_harm(word):
    line, law = learned(word)
    for k in range(60):
        values = list(line.read())
        values[k % 5] = (math.nan, math.inf, -math.inf)[k % 3]
        (step,) = law.step(snapshot(line.tick, *values), CYCLE_S, FREE)
        assert math.isfinite(step.value + step.peak_bound + step.slew_bound)
        line.advance(step.value)
    line.run(law, 2.0, fresh=False)
    line.run(law, 20.0)
    assert rms(line.run(law, 2.0)) < 0.1


def test_on_a_slow_line_nothing_goes_out(word):
    line, law = learned(word)
    line.omega = 0.3
    line.run(law, 2.0)
    (step,) = law.step(snapshot(line.tick, *line.read()), CYCLE_S, FREE)
    assert step.value == step.peak_bound == 0.0
