"""The control traps of the field, by number, each as a short scenario for the shape law."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from aff_runtime.base.signals import Permission
from aff_runtime.core.controller import Controller
from aff_runtime.core.params import RollParams, ShapeParams
from aff_runtime.core.phase import Quality, RollPhase, Source
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from tests.aff_runtime.config import test_check
from tests.aff_runtime.core.plants import (
    ACTUATOR,
    CYCLE_S,
    SWRAP,
    UNWIND,
    LagDelay,
    Line,
    measured,
    site,
    snapshot,
    with_blocks,
)
from tests.aff_runtime.core.shape_site import DRIVE, GAIN_N_S_M, LENGTH_ONLY, Rig, actuator

ONE = {("unwind", 1): 1.0 + 0.5j}
KNOWN = LagDelay(GAIN_N_S_M, delay=2, lag=0.6)


def rms(trace, seconds=2.0) -> float:
    return float(np.std(trace[-round(seconds / CYCLE_S) :]))


def start_rms(ripple=ONE) -> float:
    return math.sqrt(sum(abs(c) ** 2 for c in ripple.values()) / 2)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_T1_the_sign_comes_from_P_not_from_the_print(sign):
    rig = Rig(actuator(orders=(1,)), plant=LagDelay(sign * GAIN_N_S_M), ripple=ONE)
    assert rms(rig.run(8.0)) < 0.05 * start_rms()


@pytest.mark.parametrize("delay", [10, 40, 70])
def test_T2_phase_decides_and_is_turned_back(delay):
    """70 samples at 5 rad/s are 100 degrees: the printed law diverges there."""
    rig = Rig(actuator(orders=(1,)), plant=LagDelay(GAIN_N_S_M, delay=delay), ripple=ONE)
    assert rms(rig.run(12.0)) < 0.05 * start_rms()


def test_T2_a_hidden_delay_of_more_than_90_degrees_is_learned():
    hidden = LagDelay(GAIN_N_S_M, delay=65)
    rig = Rig(actuator(orders=(1,)), plant=hidden, known=LagDelay(GAIN_N_S_M), ripple=ONE)
    assert rms(rig.run(15.0)) < 0.3 * start_rms()


def test_T3_a_gain_that_is_safe_now_stays_safe_as_the_frequency_rises():
    rig = Rig(actuator(orders=(1, 2)), ripple=ONE, plant=LagDelay(GAIN_N_S_M, delay=20, lag=0.9))
    for _ in range(3000):
        for phase in rig.phases.values():
            phase.omega_rad_s *= 1.0003
        rig.tick()
    assert rig.phases["unwind"].omega_rad_s > 12.0
    assert rms(rig.run(2.0)) < 0.1 * start_rms()


def on_the_wire(**roll) -> tuple[Line, Controller]:
    """The law as it runs: angles come out of channels, as the site file names them."""
    line = Line(LagDelay(GAIN_N_S_M, delay=2, lag=0.6), ONE)
    params = replace(
        site(actuator(orders=(1,))),
        rolls=(replace(UNWIND, line_speed="line_speed_m_s", **roll), SWRAP),
    )
    response = measured(line.plant.at, np.geomspace(0.2, 18.0, 20))
    return line, Controller(params, {"unwind": response})


@pytest.mark.parametrize("angle", ["unwind_angle_rad", None])
def test_T4_a_change_of_speed_makes_no_jump_of_phase(angle):
    """sin(w t) with another w jumps by t dw; here the angle is read, or else integrated."""
    line, law = on_the_wire(angle=angle)
    line.run(law, 10.0)
    before = law.phases.by_name["unwind"].theta_rad
    off = before - line.theta
    for k in range(400):
        line.omega = 5.0 + 0.5 * math.sin(0.05 * k)
        line.run(law, CYCLE_S)
        missed = law.phases.by_name["unwind"].theta_rad - line.theta - off
        assert abs(missed) < 0.02  # w t would be off by up to 5 rad
    assert rms(line.run(law, 2.0)) < 0.1 * start_rms()


def test_T5_an_error_of_the_radius_tag_does_not_detune_an_angle():
    """Line speed over radius is 3 % off, the angle is not; without it the same tag detunes."""
    line, law = on_the_wire(radius_m=1.03 * UNWIND.radius_m)
    assert rms(line.run(law, 12.0)) < 0.05 * start_rms()
    line, law = on_the_wire(radius_m=1.03 * UNWIND.radius_m, angle=None)
    assert rms(line.run(law, 12.0)) > 0.1 * start_rms()


def crossing_rig() -> tuple[Rig, list[float]]:
    """Run unwind 1x slowly through the S-wrap's 1x."""
    ripple = {("unwind", 1): 1.0 + 0j, ("swrap", 1): 0.4 + 0.3j}
    rig = Rig(actuator(orders=(1,), extra=(("swrap", (1,)),)), ripple=ripple)
    rig.noise_N = 0.1
    rig.phases["swrap"].omega_rad_s = 5.0
    trace = []
    for k in range(4000):
        rig.phases["unwind"].omega_rad_s = 4.4 + 1.2 * k / 4000
        trace.append(rig.tick())
    return rig, trace


def test_T7_orders_that_meet_neither_diverge_nor_add_gain():
    _, trace = crossing_rig()
    assert np.abs(trace[1500:]).max() < 0.3


def test_T8_orders_that_meet_are_marked_and_not_saved():
    params = actuator(orders=(1, 2), extra=(("swrap", (1,)),))
    rig = Rig(params, ripple=ONE)
    swrap = rig.phases["swrap"]
    swrap.omega_rad_s, swrap.radius_m = 5.02, 1.0 / 5.02
    rig.run(2.0)
    assert list(rig.law.profile().weight_m) == [("unwind", 2)]


def test_T9_saturation_does_not_wind_up():
    ripple = {("unwind", 1): 3.0 + 0j}
    free = Rig(actuator(orders=(1,)), ripple=ripple)
    free.run(8.0)
    rig = Rig(actuator(orders=(1,)), ripple=ripple)
    rig.limit = 0.9 * free.last.peak_bound
    rig.run(8.0)
    assert abs(rig.law.weight[0]) == pytest.approx(abs(free.law.weight[0]), rel=0.15)
    rig.limit = math.inf
    assert rms(rig.run(10.0)) < 0.05 * start_rms(ripple)


def test_T10_a_limit_makes_no_harmonics():
    rig = Rig(actuator(orders=(1,)), ripple={("unwind", 1): 3.0 + 0j})
    rig.limit = 0.003
    rig.run(6.0)
    sent, angle = [], []
    for _ in range(1000):
        angle.append(rig.phases["unwind"].theta_rad)
        rig.tick()
        sent.append(rig.u)
    turns = np.array(angle)
    design = np.column_stack([f(n * turns) for n in (1, 2, 3) for f in (np.cos, np.sin)])
    fit = np.linalg.lstsq(design, np.array(sent), rcond=None)[0].reshape(3, 2)
    size = np.hypot(fit[:, 0], fit[:, 1])
    assert size[1:].max() < 0.02 * size[0]


def test_T11_a_stop_fades_the_output_and_freezes_what_was_learned():
    rig = Rig(ripple=ONE)
    rig.run(8.0)
    for phase in rig.phases.values():
        phase.omega_rad_s = 0.0
    rig.run(2.0)
    weight = rig.law.weight.copy()
    rig.run(2.0)
    assert rig.u == 0.0
    assert (rig.law.weight == weight).all()


def test_T12_a_splice_forgets_the_roll_by_its_id():
    plant = LagDelay(GAIN_N_S_M)
    response = measured(plant.at, np.geomspace(0.2, 18.0, 20))
    law = Controller(site(actuator(orders=(1,))), {"unwind": response})
    free = Permission(adapt=True, applied_ratio=(1.0,), limit_ratio=(1.0,))

    def go(roll_id: int, ticks: range, ripple_N: float) -> None:
        for k in ticks:
            theta = 5.0 * CYCLE_S * k
            values = (90.0 + ripple_N * math.cos(theta), 90.0, 1.0, theta, 0.0)
            law.step(snapshot(k, *values, roll_id=roll_id), CYCLE_S, free)

    go(1, range(800), 1.0)
    (actuator_law,) = law._laws
    learned = abs(actuator_law.weights()[("unwind", 1)])
    assert learned > 1e-4
    go(2, range(800, 800 + 100), 0.0)
    assert abs(actuator_law.weights()[("unwind", 1)]) < 0.5 * learned


def test_T13_a_radius_outside_its_bounds_is_not_believed():
    roll = RollParams(name="u", angle="a", radius="r", radius_min_m=0.05, radius_max_m=0.3)
    phase = RollPhase(roll, {"a": 0, "r": 1})
    phase.step((0.0, 0.2), CYCLE_S, True)
    for bad in (0.0, 7.0, math.nan, -0.2):
        phase.step((0.0, bad), CYCLE_S, True)
        assert phase.radius_m == 0.2


def test_T14_a_drift_of_the_load_cell_is_bias_not_ripple():
    rig = Rig(actuator(orders=(1,)), ripple=ONE)
    rig.run(8.0)
    before = rig.law.weight[0]
    for k in range(2000):
        true = rig.plant.y + rig.disturbance()
        rig.tick(signal=90.0 + true + 0.002 * k)
    assert rig.law.weight[0] == pytest.approx(before, rel=0.15)


def test_T15_a_ripple_that_does_not_grow_with_speed_is_told_from_a_shape():
    """Imbalance and eccentricity look alike at one speed; two speeds tell them apart."""
    rig = Rig(actuator(orders=(1,)))
    basis, omega = rig.law.basis, 5.0
    heavy, shape = [], []
    for factor in (1.0, 3.0):
        rig.phases["unwind"].omega_rad_s = factor * omega
        rig.run(6.0, adapt=False)
        shape.append(abs(basis.b[0]))
        heavy.append(abs(basis.b[1]))
    assert shape[1] / shape[0] > 2.5
    assert heavy[1] / heavy[0] < 1.5


def test_T18_a_filter_in_the_amplifier_is_part_of_P():
    """100 ms turn order n by atan(5 n / 10); what P does not hold of it is left to be learned."""

    def slow() -> LagDelay:
        return LagDelay(GAIN_N_S_M, delay=2, lag=math.exp(-CYCLE_S / 0.1))

    rig = Rig(actuator(orders=(1, 2)), plant=slow(), ripple=ONE)
    assert rms(rig.run(12.0)) < 0.05 * start_rms()
    assert np.abs(rig.law.filter.response_ratio_less_1[:2]).max() < 0.05
    blind = Rig(
        actuator(orders=(1, 2)), plant=slow(), known=LagDelay(GAIN_N_S_M, delay=2), ripple=ONE
    )
    blind.run(12.0)
    assert np.angle(blind.law.filter.response_ratio[0]) == pytest.approx(-math.atan(0.5), abs=0.05)


def test_T19_a_repeated_sample_is_not_learned_from():
    rig = Rig(actuator(orders=(1,)), ripple=ONE)
    for k in range(3000):
        repeated = k % 3 == 2
        state = rig.law.filter.state.copy()
        rig.tick(fresh=not repeated, signal=rig.inputs.signal if repeated else None)
        assert not repeated or (rig.law.filter.state == state).all()
    assert rms(rig.run(2.0)) < 0.05 * start_rms()


def test_T20_without_a_measured_closed_loop_the_law_is_not_there():
    law = Controller(site(actuator(orders=(1,))), {})
    assert law.arming_objections()["unwind"] == ("no measured response; run the probe",)


def test_T20_the_sign_of_a_measured_response_is_its_own():
    points = [
        ResponsePoint(
            frequency_Hz=f, gain=200.0, phase_rad=math.pi, relative_error=0.01, coherence=0.99
        )
        for f in (0.2, 1.0, 5.0)
    ]
    response = Response(
        points=points, delay_s=0.0, provenance=Provenance(actuator="unwind", signal="t")
    )
    assert response.at(1.0).real == pytest.approx(-200.0)


@pytest.mark.parametrize("scale", [0.1, 10.0])
def test_T21_a_rescaled_signal_with_its_response_changes_nothing(scale):
    """Settling is in turns: N, lbf or counts, the trace is the same in its own unit."""
    ripple = {k: scale * c for k, c in ONE.items()}
    base = actuator(orders=(1,), drive=LENGTH_ONLY)
    params = replace(base, shape=ShapeParams(signal_sd=0.6 * scale))
    rig = Rig(params, plant=LagDelay(scale * GAIN_N_S_M), ripple=ripple)
    plain = Rig(base, plant=LagDelay(GAIN_N_S_M), ripple=ONE)
    a, b = rig.run(4.0), plain.run(4.0)
    assert a / scale == pytest.approx(b, abs=0.02)


def test_T22_the_weight_is_scaled_by_speed_through_the_drive_not_by_rule():
    """The length rate grows with speed, what pulls by torque less: s/(s + c) alone."""
    rig = Rig(actuator(orders=(1,), drive=replace(DRIVE, torque_term=False)))
    basis = rig.law.basis
    length, torque = [], []
    for omega in (1.0, 4.0):
        rig.phases["unwind"].omega_rad_s = omega
        rig.run(3.0, adapt=False)
        length.append(abs(basis.b[0]))
        torque.append(abs(basis.b[1]))
    c = rig.params.drive.corner_rad_s
    assert length[1] / length[0] == pytest.approx(3.6, abs=0.2)
    expected = 4.0 * math.hypot(1.0, c) / math.hypot(4.0, c)
    assert torque[1] / torque[0] == pytest.approx(expected, rel=0.02)


def test_every_control_trap_of_the_field_has_its_test():
    names = [*globals(), *vars(test_check)]  # the forecast of crossings is the check's
    here = {int(m[1]) for name in names if (m := re.match(r"test_T(\d+)_", name))}
    assert here >= {*range(1, 16), *range(18, 23)}


def test_without_a_declared_drive_the_plain_blocks_stand_in():
    from aff_runtime.core.blocks.bank import Bank
    from aff_runtime.core.shape.law import ShapeLaw

    response = measured(KNOWN.at, np.geomspace(0.2, 18.0, 20))
    plain = Controller(site(with_blocks(*ACTUATOR.blocks, law="shape")), {"unwind": response})
    shaped = Controller(site(actuator(orders=(1,))), {"unwind": response})
    assert isinstance(plain._laws[0], Bank)
    assert isinstance(shaped._laws[0], ShapeLaw)


def test_an_angle_that_is_lost_is_replaced_by_the_line_speed():
    roll = RollParams(name="u", angle="a", line_speed="v", radius_m=0.2)
    phase = RollPhase(roll, {"a": 0, "v": 1})
    for k in range(200):
        phase.step((0.025 * k, 1.0), CYCLE_S, True)
    for _ in range(200):
        phase.step((math.nan, 1.0), CYCLE_S, True)
    assert phase.source is Source.LINE_SPEED
    assert phase.quality is Quality.GOOD
