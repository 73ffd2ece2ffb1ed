"""The compiled shape law and the one of numpy are the same law: random sites, faults, edits."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pytest

from aff_runtime.core.compiled.binary import chosen, using
from aff_runtime.core.impulse import LoopModel, from_taps
from aff_runtime.core.law import Inputs
from aff_runtime.core.params import ShapeParams
from aff_runtime.core.phase import Quality
from aff_runtime.core.shape.law import ShapeLaw
from tests.aff_runtime.core.plants import CYCLE_S, LagDelay, measured
from tests.aff_runtime.core.shape_site import DRIVE, GAIN_N_S_M, Phase, actuator

pytestmark = pytest.mark.skipif(chosen() is None, reason="no binary was built")
CLOSE = 1e-12
TICKS = 450
OF_A_COLUMN = ("weight", "_sent", "_signal_per_m")


@dataclass(slots=True)
class Twins:
    """One law twice, numpy's and the binary's, on the same rolls; the plant hears numpy's."""

    rng: np.random.Generator
    phases: dict[str, Phase]
    laws: tuple[ShapeLaw, ShapeLaw]
    plant: LagDelay
    given: Inputs
    u: float = 0.0


def loop_by_radius(rng: np.random.Generator) -> LoopModel:
    """Two impulse responses, of a length that is no whole number of blocks."""
    decay = np.exp(-np.arange(int(rng.integers(50, 250))) / 20.0)
    taps = [GAIN_N_S_M * 0.05 * decay * rng.uniform(0.8, 1.2) for _ in range(2)]
    return from_taps((0.05, 0.2), taps)


def drawn(seed: int) -> Twins:
    """Draw a site: orders, rolls, drive, response, sizes."""
    rng = np.random.default_rng(seed)
    orders = sorted(rng.choice(np.arange(1, 25), size=int(rng.integers(1, 12)), replace=False))
    extra = (("swrap", (1, 2)[: int(rng.integers(1, 3))]),) if rng.random() < 0.6 else ()
    drive = replace(
        DRIVE,
        torque_term=bool(rng.random() < 0.8),
        imbalance=bool(rng.random() < 0.7),
        web_density_kg_m3=400.0,
        web_width_m=0.15,
        web_leaves_rad=float(rng.uniform(0.0, 6.0)),
    )
    shape = ShapeParams(weight_limit_m=float(rng.choice([2e-4, 0.015])))
    params = actuator(orders=tuple(map(int, orders)), extra=extra, drive=drive, shape=shape)
    omega = float(rng.uniform(1.0, 12.0))
    phases = {"unwind": Phase(omega, 0.2, 0.3), "swrap": Phase(0.2 / 0.09 * omega, 0.09, 1.1)}
    plant = LagDelay(GAIN_N_S_M * rng.choice([0.0, 0.6, 1.0, -1.0]), delay=2, lag=0.6)
    return Twins(rng, phases, both(params, phases, loop_by_radius(rng), rng), plant, Inputs())


def both(params, phases, loop, rng) -> tuple[ShapeLaw, ShapeLaw]:
    """Build the law by numpy and by the binary."""
    known = LagDelay(GAIN_N_S_M, delay=2, lag=0.6)
    response = measured(known.at, np.geomspace(0.4, 9.0, 12)) if rng.random() < 0.7 else None
    made = []
    for arithmetic in (None, chosen()):
        with using(arithmetic):
            law = ShapeLaw(
                params,
                drive=params.drive,
                phases=phases,
                loop=loop,
                cycle_s=CYCLE_S,
                response=response,
            )
        made.append(law)
    return made[0], made[1]


def fault(twins: Twins, tick: int) -> None:
    """Let something happen that a line does, or that an operator does."""
    rng, (unwind, swrap) = twins.rng, twins.phases.values()
    given, draw = twins.given, rng.random()
    given.fresh, given.dt_s, given.adapt = draw > 0.03, CYCLE_S, draw < 0.97
    if draw < 0.01:
        given.dt_s = CYCLE_S * int(rng.integers(2, 60))
    given.signal = 90.0 + twins.plant.step(twins.u) + ripple(unwind.theta_rad)
    given.signal += 0.2 * rng.standard_normal()
    if 0.1 < draw < 0.11:
        given.signal = float(rng.choice([math.nan, math.inf, 1e9]))
    given.reference = math.nan if 0.2 < draw < 0.21 else 90.0
    given.line_speed_m_s = unwind.omega_rad_s * unwind.radius_m
    if 0.3 < draw < 0.31:
        given.line_speed_m_s = math.nan
    for phase in (unwind, swrap):
        phase.quality = Quality.LOST if tick % 211 > 200 else Quality.GOOD
        phase.omega_rad_s *= 1.0 + 0.001 * math.sin(0.01 * tick)
        phase.turn()
    unwind.radius_m *= 1.0 - 2e-5
    if tick == 400:
        for law in twins.laws:
            law.reset_roll("unwind")


def ripple(theta_rad: float) -> float:
    return 2.0 * math.cos(theta_rad) - 0.8 * math.sin(2.0 * theta_rad)


def step(twins: Twins) -> None:
    """Advance both; the guard shortens what is above a limit."""
    reference, law = (law.step(twins.given) for law in twins.laws)
    for name in ("value", "peak_bound", "slew_bound"):
        mine, theirs = getattr(law, name), getattr(reference, name)
        assert abs(mine - theirs) <= CLOSE * max(abs(theirs), reference.peak_bound, 1e-6), name
    limit = 0.004
    scale = min(1.0, limit / reference.peak_bound) if reference.peak_bound > 0 else 1.0
    twins.given.limit_ratio = twins.given.applied_ratio = scale
    twins.u = reference.value * scale


def numbers(law: ShapeLaw) -> Iterator[tuple[str, np.ndarray]]:
    """Everything that a law keeps from tick to tick."""
    yield from law.state._arrays.items()
    yield from ((name, getattr(law, name)) for name in OF_A_COLUMN)
    yield "step", law._newton.step_1_s
    yield from (("state", law.filter.state), ("covariance", law.filter.covariance))
    yield from (("ring", law._loop._ring), ("tails", law._loop._tails), ("phi", law._loop._out))
    yield from (("turns", law.basis._turns), ("noted", law.filter._turn_s))


def compare(twins: Twins) -> None:
    reference, law = twins.laws
    for (name, theirs), (_, mine) in zip(numbers(reference), numbers(law), strict=True):
        known = np.isfinite(theirs)
        assert (known == np.isfinite(mine)).all(), name
        size = np.abs(theirs[known]).max(initial=0.0)
        assert np.abs(mine[known] - 1.0 * theirs[known]).max(initial=0.0) <= CLOSE * size, name
    for part in ("adapting", "monitor.calm", "allocation.limited", "availability.known"):
        mine, theirs = law, reference
        for word in part.split("."):
            mine, theirs = getattr(mine, word), getattr(theirs, word)
        assert mine == theirs, part
    go_on_alike(twins)


def go_on_alike(twins: Twins) -> None:
    """Give the binary's law the other's numbers: what is compared next is of the next ticks."""
    reference, law = twins.laws
    for (_, theirs), (_, mine) in zip(numbers(reference), numbers(law), strict=True):
        mine[...] = theirs


def run(twins: Twins, ticks: int) -> None:
    """Let both run, and hold them beside each other every 25 ticks."""
    for tick in range(ticks):
        fault(twins, tick)
        step(twins)
        if tick % 25 == 24:
            compare(twins)


@pytest.mark.parametrize("seed", range(6))
def test_the_same_numbers_whatever_the_line_does(seed):
    run(drawn(seed), TICKS)


@pytest.mark.parametrize("seed", range(100, 103))
def test_the_same_numbers_after_an_edit(seed):
    twins = drawn(seed)
    run(twins, 150)
    orders = tuple(range(1, int(twins.rng.integers(2, 10))))
    params = actuator(orders=orders, extra=(("swrap", (1,)),))
    old, twins.laws = (
        twins.laws,
        both(params, twins.phases, loop_by_radius(twins.rng), twins.rng),
    )
    for before, law in zip(old, twins.laws, strict=True):
        law.adopt(before)
    compare(twins)
    run(twins, 150)


def test_a_law_that_lost_its_effect_starts_anew_alike():
    twins = drawn(3)
    twins.plant.gain = 0.0
    for _ in range(6):
        run(twins, 200)
    assert not all(law.monitor.calm for law in twins.laws)


def test_an_array_of_another_size_is_refused():
    law = drawn(1).laws[1]
    with pytest.raises(ValueError, match="loop_push"):
        law._loop.push(np.zeros(1, dtype=np.complex128), law._sent, 1.0, 1)


def test_what_is_no_hold_is_refused():
    with pytest.raises(TypeError, match="loop_read"):
        chosen().loop_read(np.zeros(3))
