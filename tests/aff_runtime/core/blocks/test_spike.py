"""A spike in the signal costs no weight what only its own step takes of the slew limit."""

from __future__ import annotations

import math
from copy import deepcopy
from functools import cache

import pytest

from aff_runtime.base.signals import Permission
from aff_runtime.core.controller import Controller
from aff_runtime.core.law import Inputs
from tests.aff_runtime.core.plants import (
    CYCLE_S,
    GRID_HZ,
    RIPPLE,
    LagDelay,
    Line,
    measured,
    site,
    snapshot,
)

LIMIT = 0.05
SPIKE_N = 60.0


class Limited:
    """A law under a limit of slew; the guard's answer follows its formula (``safety.limits``)."""

    def __init__(self):
        plant = LagDelay(-400.0, delay=12, lag=0.96)
        self.law = Controller(site(), {"unwind": measured(plant.at, GRID_HZ)})
        self.line = Line(plant, RIPPLE)
        self.limit, self.slew_limit = LIMIT, math.inf
        self.ratio, self.last = 1.0, None

    def run(self, seconds, spike_N=0.0):
        for _ in range(round(seconds / CYCLE_S)):
            room = self.limit, self.slew_limit
            given = Permission(
                adapt=True, applied_ratio=(1.0,), limit_ratio=(self.ratio,), headroom=(room,)
            )
            signal, *others = self.line.read()
            read = snapshot(self.line.tick, signal + spike_N, *others)
            (self.last,) = self.law.step(read, CYCLE_S, given)
            step, self.ratio = self.last, 1.0
            if step.peak_bound > self.limit:
                self.ratio = self.limit / step.peak_bound
            if step.slew_bound * self.ratio > self.slew_limit:
                self.ratio = self.slew_limit / step.slew_bound
            self.line.advance(step.value * self.ratio)

    @property
    def weights(self):
        (law,) = self.law._laws
        return law.weights()


@cache
def _learned():
    rig = Limited()
    rig.run(25.0)
    assert rig.ratio == 1.0  # below its limits
    return rig


def learned():
    """Return a law that has run for 25 s; a copy for each test."""
    return deepcopy(_learned())


def test_a_spike_under_a_tight_slew_limit_leaves_the_weights_as_without_one():
    free, tight = learned(), learned()
    tight.slew_limit = 2.5 * tight.last.slew_bound
    for rig in (free, tight):
        rig.run(CYCLE_S, SPIKE_N)
    assert tight.ratio < 0.5  # the guard itself does bound that tick
    for rig in (free, tight):
        rig.run(CYCLE_S)
    for key, weight in free.weights.items():
        assert abs(tight.weights[key] - weight) < 1e-6 * abs(weight)


def test_the_steps_of_learning_count_as_before():
    """Beside weights that turn at the limit, steps are small: the guard's ratio is the law's."""
    rig = learned()
    rig.slew_limit = 0.8 * rig.last.slew_bound
    rig.run(CYCLE_S)
    before, ratio = rig.weights, rig.ratio
    assert ratio < 0.9
    rig.law._laws[0].step(Inputs(limit_ratio=ratio, slew_limit=rig.slew_limit, dt_s=CYCLE_S))
    for key, weight in before.items():
        assert abs(rig.weights[key] - ratio * weight) < 1e-12


@pytest.mark.parametrize(("limit", "share", "seconds"), [(LIMIT, 0.5, 60.0), (0.5, 0.0, 20.0)])
def test_a_limit_in_force_winds_up_no_weight(limit, share, seconds):
    """By slew, and by peak: after a while under the limit what goes out still fits it."""
    rig = learned()
    whole = rig.last
    rig.limit = limit if share else 0.5 * whole.peak_bound
    rig.slew_limit = share * whole.slew_bound if share else math.inf
    rig.run(seconds)
    assert rig.last.peak_bound <= rig.limit * 1.02
    assert rig.last.slew_bound <= rig.slew_limit * 1.05
    assert rig.last.peak_bound >= 0.4 * whole.peak_bound
