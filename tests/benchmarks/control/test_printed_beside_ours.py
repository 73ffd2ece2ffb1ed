"""The printed law and ours side by side: same line, same seed, 200 FPM, half a minute.

The printed laws are kept as expected failures of the statement "the ripple falls": (5.10) has the
sign of its velocity error wrong, (5.14) knows no phase of the line and so fails where the tension
answers more than 90 degrees late, at 200 FPM from the third order on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from aff_runtime.app.wiring.site_to_law import site_params
from aff_runtime.config.loader import load_site
from aff_runtime.core.params import BlockParams, SiteParams
from benchmarks.control.printed import with_printed
from sim_plant.base.arrays import Array
from sim_plant.base.order_tracking import order_amplitudes
from tests.lockstep.bench import SITE, Bench, Setup
from tests.lockstep.known_response import known_responses
from tests.lockstep.silent import SKIPPED_S, silent

pytestmark = pytest.mark.long  # one of them in a minute: test_printed.py
CLAMP_M_S = 0.02
LEARN_S, JUDGED_S = 30.0, 10.0
TENSION = ("unwind_tension_N", "tension_ref_N")
VELOCITY = ("swrap_follower_speed_m_s", "line_speed_m_s")
PULLROLL = ("pullroll_tension_N", None)


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One block on one actuator: error signal and reference, gain as printed (0: our law)."""

    actuator: str
    order: int
    error: tuple[str, str | None]
    gain: float = 0.0


PRINTED_5_10 = Case(actuator="swrap_follower", order=1, error=VELOCITY, gain=0.5)
OURS_BESIDE_5_10 = Case(actuator="swrap_follower", order=1, error=PULLROLL)
PRINTED_5_14_1X = Case(actuator="unwind", order=1, error=TENSION, gain=0.001)
PRINTED_5_14_3X = Case(actuator="unwind", order=3, error=TENSION, gain=0.001)
OURS_BESIDE_5_14 = Case(actuator="unwind", order=3, error=TENSION)


def _law(case: Case) -> SiteParams:
    """Return the site with one block, on the roll of its own actuator."""
    block = BlockParams(
        roll=case.actuator, orders=(case.order,), settle_s=6.0, amp_limit=CLAMP_M_S
    )
    site = site_params(load_site(SITE))
    return replace(
        site,
        actuators=tuple(
            replace(
                a,
                signal=case.error[0],
                reference=case.error[1],
                law="printed" if case.gain else "blocks",
                blocks=(block,),
            )
            if a.name == case.actuator
            else replace(a, blocks=())
            for a in site.actuators
        ),
    )


def _ripple_N(tension_N: Array, angle_rad: Array, other_rad: Array, order: int) -> float:
    return float(abs(order_amplitudes(tension_N, angle_rad, (order,), {"o": other_rad})[0]))


@cache
def _outcome(case: Case) -> tuple[float, float]:
    """Return ripple after as a share of before, and the block's amplitude, m/s."""
    actuator, order = case.actuator, case.order
    bench = Bench(Setup(responses=known_responses(), law=_law(case), laws=with_printed(case.gain)))
    tension = "unwind" if actuator == "unwind" else "pullroll"
    other = "swrap_follower" if actuator == "unwind" else "unwind"
    names = f"true_{tension}_tension_N", f"true_{actuator}_angle_rad", f"true_{other}_angle_rad"
    seen: list[tuple[float, float, float]] = []
    bench.plant.observers.append(lambda p: seen.append(tuple(p.measured[n] for n in names)))
    bench.run(SKIPPED_S)
    bench.arm(LEARN_S)
    seen.clear()
    bench.run(JUDGED_S)
    columns = dict(zip(bench.law.telemetry_names(), bench.law.telemetry(), strict=True))
    amplitude = columns[f"{actuator}.{actuator}_{order}x.amplitude_m_s"]
    before_N = _ripple_N(*(silent(name) for name in names), order)
    return _ripple_N(*np.array(seen).T, order) / before_N, amplitude


@pytest.mark.xfail(strict=True, reason="(5.10) as printed adds to the ripple: wrong sign")
def test_printed_5_10_on_velocity_error_converges():
    left, _ = _outcome(PRINTED_5_10)
    assert left < 1.0


def test_printed_5_10_runs_into_its_clamp():
    left, amplitude_m_s = _outcome(PRINTED_5_10)
    assert left > 2.0
    assert amplitude_m_s == pytest.approx(CLAMP_M_S, rel=0.01)


def test_ours_converges_where_5_10_diverges():
    left, amplitude_m_s = _outcome(OURS_BESIDE_5_10)
    assert left < 0.1
    assert amplitude_m_s < 0.8 * CLAMP_M_S


@pytest.mark.xfail(strict=True, reason="(5.14) without phase advance is over 90 deg late on 3x")
def test_printed_5_14_on_the_third_order_converges():
    left, _ = _outcome(PRINTED_5_14_3X)
    assert left < 1.0


def test_printed_5_14_runs_into_its_clamp_on_the_third_order():
    left, amplitude_m_s = _outcome(PRINTED_5_14_3X)
    assert left > 2.0
    assert amplitude_m_s == pytest.approx(CLAMP_M_S, rel=0.01)


def test_printed_5_14_helps_on_the_first_order_where_the_phase_is_small():
    left, _ = _outcome(PRINTED_5_14_1X)
    assert left < 0.5


def test_ours_converges_where_5_14_diverges():
    left, amplitude_m_s = _outcome(OURS_BESIDE_5_14)
    assert left < 0.1
    assert amplitude_m_s < 0.8 * CLAMP_M_S
