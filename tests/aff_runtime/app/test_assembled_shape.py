"""The shape law as the site file assembles it: which law runs, and what always holds."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.app.wiring.assemble import controller_of
from aff_runtime.app.wiring.impulse_responses import taps_by_actuator
from aff_runtime.app.wiring.site_to_guard import guard_params
from aff_runtime.app.wiring.site_to_law import probe_params, site_params
from aff_runtime.base.signals import Outcome, Permission, Snapshot
from aff_runtime.config.loader import load_site
from aff_runtime.core.blocks.bank import Bank
from aff_runtime.core.controller import Controller
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from aff_runtime.core.shape.law import ShapeLaw
from aff_runtime.safety.limits import Limiter, makes_sense
from tests.drawn import drawn
from tests.parameter_records import record_of

SITE = Path(__file__).parents[3] / "config" / "euclid.yaml"
EUCLID = load_site(SITE)
CYCLE_S = EUCLID.cycle_s
REFERENCE_N = 89.0
SPEED_M_S = 1.016
COUNT_RAD = math.tau / 4096


def response(actuator: str, relative_error: float = 0.02) -> Response:
    """Return a first-order loop with a delay of 40 ms, known from 0.2 to 20 Hz."""
    points = []
    for f in np.geomspace(0.2, 20.0, 40):
        p = 300.0 / (1.0 + 1j * f / 2.0)
        points.append(
            ResponsePoint(
                frequency_Hz=float(f),
                gain=abs(p),
                phase_rad=float(np.angle(p)) - math.tau * float(f) * 0.04,
                relative_error=relative_error if f < 9.0 else 5.0 * relative_error,
                coherence=0.99,
            )
        )
    signal = EUCLID.actuators[actuator].error.signal
    about = Provenance(actuator=actuator, signal=signal, cycle_s=CYCLE_S)
    return Response(points=points, delay_s=0.04, provenance=about)


RESPONSES = {name: response(name).to_json() for name in EUCLID.actuators}
TAPS = taps_by_actuator(EUCLID, RESPONSES)
RECORD = record_of(EUCLID, responses=RESPONSES, loops=TAPS)
OPEN = Permission(adapt=True, applied_ratio=(1.0, 1.0), limit_ratio=(1.0, 1.0))
SHUT = Permission(adapt=False, applied_ratio=(0.0, 0.0), limit_ratio=(1.0, 1.0))


class Line:
    """A line that turns and ripples, as the law reads it; nothing comes back from its output."""

    def __init__(self) -> None:
        self.law = controller_of(EUCLID, RESPONSES, TAPS)
        self.tick = 0

    def values(self, ripple_N: float = 1.0, **spoilt: float) -> tuple[float, ...]:
        travel_m = SPEED_M_S * self.tick * CYCLE_S
        unwind, follower = travel_m / 0.2, travel_m / 0.15367
        ripple = ripple_N * (math.cos(unwind) + 0.5 * math.cos(2 * unwind + 1.0))
        known = {
            "unwind_tension_N": REFERENCE_N + ripple,
            "tension_ref_N": REFERENCE_N,
            "line_speed_m_s": SPEED_M_S,
            "unwind_radius_m": 0.2,
            "pullroll_tension_N": REFERENCE_N,
            "unwind_angle_rad": COUNT_RAD * round(unwind / COUNT_RAD),
            "swrap_follower_angle_rad": COUNT_RAD * round(follower / COUNT_RAD),
            "swrap_follower_speed_m_s": SPEED_M_S,
            **spoilt,
        }
        return tuple(known[name] for name in EUCLID.gateway.read.channels)

    def step(self, permission=OPEN, fresh=True, ripple_N=1.0, **spoilt):
        self.tick += 1
        snapshot = Snapshot(
            tick=self.tick,
            t_ns=0,
            outcome=Outcome.OK,
            fresh=fresh,
            age_s=0.0,
            plc_heartbeat=self.tick,
            status=255,
            roll_id=1,
            values=self.values(ripple_N, **spoilt),
        )
        return self.law.step(snapshot, CYCLE_S, permission)

    def run(self, seconds: float, **given) -> list:
        return [self.step(**given) for _ in range(round(seconds / CYCLE_S))]

    @property
    def shape(self) -> ShapeLaw:
        return self.law.shape_laws()["unwind"]


def test_the_unwind_runs_the_shape_law_and_the_follower_its_blocks():
    laws = Line().law._laws
    assert [type(law) for law in laws] == [ShapeLaw, Bank]


def test_without_a_response_the_blocks_stand_in_and_nothing_arms():
    law = controller_of(EUCLID, {}, {})
    assert not law.shape_laws()
    assert "no measured response" in law.arming_objections()["unwind"][0]


def test_the_declared_drive_reaches_the_law_in_si():
    drive = site_params(EUCLID).actuators[0].drive
    assert drive is not None
    assert (drive.K_ref_rad_s, drive.zeta, drive.inertia_kg_m2) == (15.0, 1.1, 0.25)
    assert drive.web_width_m == pytest.approx(0.1524)
    assert site_params(EUCLID).actuators[0].transport_s == pytest.approx(0.015)


def test_the_loop_is_worked_out_by_the_check_and_not_by_the_cycle(monkeypatch):
    def too_slow(*_, **__):
        raise AssertionError("worked out between two ticks")

    monkeypatch.setattr("aff_runtime.core.laws.catalogue.from_response", too_slow)
    assert controller_of(EUCLID, RESPONSES, TAPS).shape_laws()


def test_the_probe_plays_up_to_where_orders_fade_and_clear_of_all_ripple():
    params = probe_params(EUCLID, ["unwind", "swrap_follower"])
    assert params.f_max_Hz > 19.0
    assert params.nuisance_orders == 24


def test_the_law_learns_on_this_line():
    line = Line()
    line.run(3.0)
    assert abs(line.shape.weights()["unwind", 1]) > 1e-4


def test_a_line_that_does_not_answer_is_found_out_within_eight_turns():
    """This line ripples whatever goes out, as with a drive that takes no correction."""
    line = Line()
    line.run(10.0)
    assert line.shape.monitor.resting[0]
    assert line.shape.weights()["unwind", 1] == 0j


VALUE = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True),
    st.floats(-500.0, 500.0),
    st.sampled_from([math.nan, math.inf, -math.inf, 0.0, 1e300, -1e300]),
)
CHANNEL = st.sampled_from(list(EUCLID.gateway.read.channels))
TROUBLE = st.lists(
    st.tuples(st.dictionaries(CHANNEL, VALUE, max_size=3), st.booleans(), st.booleans()),
    min_size=1,
    max_size=25,
)


@drawn(quick=6, long=100)
@given(trouble=TROUBLE)
def test_whatever_is_read_no_output_exceeds_its_limits_and_no_nan_goes_out(trouble):
    guard = guard_params(EUCLID)
    limiters = [Limiter(bounds, guard.fade_s) for bounds in guard.actuators]
    line = Line()
    line.run(1.0)
    for spoilt, fresh, adapt in trouble:
        permission = replace(OPEN, adapt=adapt)
        for repeat in range(4):
            given_values = spoilt if repeat == 0 else {}
            for step, limiter, bounds in zip(
                line.step(permission, fresh, **given_values),
                limiters,
                guard.actuators,
                strict=True,
            ):
                assert makes_sense(step)
                assert abs(step.value) <= step.peak_bound * (1.0 + 1e-9) + 1e-15
                limiter.step(step, 1.0, CYCLE_S)
                assert math.isfinite(limiter.output)
                assert abs(limiter.output) <= bounds.limit * (1.0 + 1e-12)


@drawn(quick=3, long=20)
@given(ripple=st.floats(0.0, 50.0), fresh=st.booleans())
def test_without_permission_nothing_changes(ripple, fresh):
    line = Line()
    line.run(2.0)
    before = dict(line.shape.weights())
    for _ in range(60):
        line.step(SHUT, fresh, ripple_N=ripple)
    assert line.shape.weights() == before


def test_without_ripple_nothing_is_learned():
    line = Line()
    steps = line.run(8.0, ripple_N=0.0)
    assert max(abs(step.value) for tick in steps for step in tick) < 1e-12
    assert all(abs(w) < 1e-12 for w in line.shape.weights().values())


def test_a_missing_sample_teaches_nothing():
    line = Line()
    line.run(2.0)
    before = dict(line.shape.weights())
    line.run(0.5, fresh=False)
    assert line.shape.weights() == before


def unsure() -> Controller:
    """Return the law with a response that knows nothing above 9 Hz: 5 * 0.15 is 90 degrees."""
    loose = {"unwind": response("unwind", 0.15).to_json()}
    return controller_of(EUCLID, loose, TAPS)


def test_an_order_whose_response_is_unsure_stays_held_and_stands_against_nothing():
    line = Line()
    line.law = unsure()
    line.run(3.0)
    law = line.shape
    held = [key for key, h in zip(law.keys, law.confidence.held, strict=False) if h]
    # a turn is 0.8086 Hz: 12x at 9.7 Hz and above are unsure
    assert ("unwind", 16) in held
    assert ("unwind", 2) not in held
    assert all(law.weights()[key] == 0j for key in held)
    assert law.objections() == ()


def test_a_block_that_the_monitor_rests_stays_as_it_is():
    line = Line()
    line.run(3.0)
    law = line.shape
    law.monitor._rest[1], law.monitor.calm = 20.0, False
    before = law.weights()["unwind", 2]
    line.run(2.0)
    assert law.weights()["unwind", 2] == before
    assert law.monitor.share[1] == 0.0


def test_new_settings_go_on_without_a_bump():
    line = Line()
    line.run(6.0)
    before = line.step()[0]
    after = controller_of(
        EUCLID.model_copy(
            update={
                "actuators": {
                    **EUCLID.actuators,
                    "unwind": EUCLID.actuators["unwind"].model_copy(update={"memory_turns": 12.0}),
                }
            }
        ),
        RESPONSES,
        TAPS,
    )
    after.adopt(line.law)
    line.law = after
    now = line.step()[0]
    assert abs(now.value - before.value) <= before.slew_bound * CYCLE_S + 1e-9
    assert line.shape.filter._memory_turns == 12.0


def test_ripple_is_unknown_until_two_turns_were_heard_and_then_has_a_before():
    line = Line()
    line.run(1.0, permission=SHUT)
    assert all(math.isnan(value) for value in line.shape.ripple())
    line.run(2.5, permission=SHUT)
    before, now = line.shape.ripple()
    assert now == pytest.approx(math.hypot(1.0, 0.5), rel=0.3)  # closed: what the roll does
    assert before >= now
