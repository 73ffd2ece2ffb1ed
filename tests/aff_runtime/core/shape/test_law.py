"""The shape law on plants of known response."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aff_runtime.core.monitor import OrderState
from aff_runtime.core.params import ShapeParams
from aff_runtime.core.phase import Quality
from tests.aff_runtime.core.plants import CYCLE_S, LagDelay
from tests.aff_runtime.core.shape_site import GAIN_N_S_M, LENGTH_ONLY, Rig, actuator

RIPPLE = {("unwind", 1): 1.2 - 0.4j, ("unwind", 2): -0.5 + 0.8j}


def tail_rms(trace: np.ndarray, seconds: float = 4.0) -> float:
    return float(np.std(trace[-round(seconds / CYCLE_S) :]))


def test_ripple_falls_by_forty_dB_within_ten_turns_with_noise():
    rig = Rig(ripple=RIPPLE)
    rig.noise_N = 0.25
    before = math.sqrt(sum(abs(c) ** 2 for c in RIPPLE.values()) / 2)
    assert tail_rms(rig.run(12.0)) < 0.05 * before


def test_the_weight_is_the_shape_in_metres():
    """Ripple that a shape makes through P is cancelled by exactly that shape."""
    shape = 0.4e-3 * np.exp(0.9j)
    rig = Rig(actuator(orders=(1,), drive=LENGTH_ONLY))
    lead = 0.5 * CYCLE_S
    omega = rig.phases["unwind"].omega_rad_s
    s = 1j * omega
    drive = rig.params.drive
    through = 1.0 + s * s / (drive.K_ref_rad_s * (s + drive.corner_rad_s))
    # the roll disturbs as -v_ff would: v = +omega (1 + s^2/(K (s + c))) W q
    p = rig.plant.at(omega / math.tau) * np.exp(1j * omega * lead)
    rig.ripple = {("unwind", 1): p * omega * through * shape}
    rig.run(15.0)
    assert rig.law.weights()[("unwind", 1)] == pytest.approx(shape, abs=4e-6)


def test_a_speed_change_needs_no_new_learning_where_P_is_flat():
    """The same shape at twice the speed: what was learned cancels it at once."""
    flat = LagDelay(GAIN_N_S_M, delay=0, lag=0.0)
    rig = Rig(actuator(orders=(1,), drive=LENGTH_ONLY), plant=flat)
    shape = 0.4e-3

    def ripple_at(omega):
        s, drive = 1j * omega, rig.params.drive
        through = 1.0 + s * s / (drive.K_ref_rad_s * (s + drive.corner_rad_s))
        lead = np.exp(1j * omega * 0.5 * CYCLE_S)
        return {("unwind", 1): rig.plant.at(omega / math.tau) * lead * omega * through * shape}

    rig.ripple = ripple_at(5.0)
    rig.run(15.0)
    weight = rig.law.weights()[("unwind", 1)]
    for roll in rig.phases.values():
        roll.omega_rad_s *= 2.0
    rig.ripple = ripple_at(10.0)
    rig.run(2.0, adapt=False)  # the filters settle, nothing is learned
    left = rig.run(4.0, adapt=False)
    assert rig.law.weights()[("unwind", 1)] == weight
    assert np.std(left) < 0.05 * abs(ripple_at(10.0)[("unwind", 1)]) / math.sqrt(2)


@pytest.mark.parametrize("delay", [6, 18])
@pytest.mark.parametrize("gain", [0.6, 1.6])
@pytest.mark.sweep(every=3)  # the two corners of both
def test_a_P_that_differs_in_gain_and_phase_is_learned_not_diverged_from(delay, gain):
    plant = LagDelay(gain * GAIN_N_S_M, delay=delay, lag=0.6)
    rig = Rig(plant=plant, known=LagDelay(GAIN_N_S_M, delay=2, lag=0.6), ripple=RIPPLE)
    rig.noise_N = 0.1
    trace = rig.run(25.0)
    assert tail_rms(trace) < 0.1
    assert np.abs(trace).max() < 4.0 * sum(abs(c) for c in RIPPLE.values())


@settings(max_examples=5, deadline=None)
@given(
    limit=st.floats(1e-4, 5e-3),
    seed=st.integers(0, 99),
    size=st.floats(0.1, 8.0),
    cap_m=st.floats(1e-5, 1e-3),
)
def test_the_bound_holds_at_every_tick_whatever_the_limit(limit, seed, size, cap_m):
    params = actuator(orders=(1, 2, 3), shape=ShapeParams(weight_limit_m=cap_m))
    rig = Rig(params, ripple={k: size * c for k, c in RIPPLE.items()}, seed=seed)
    rig.noise_N, rig.limit = 0.3, limit
    for _ in range(300):
        rig.tick()
        assert abs(rig.last.value) <= rig.last.peak_bound + 1e-12
        assert abs(rig.u) <= limit * (1 + 1e-9)
        assert np.abs(rig.law.weight).max() <= cap_m * (1 + 1e-12)


def test_a_shape_stops_at_its_limit_and_keeps_its_angle():
    free = Rig(actuator(orders=(1,), drive=LENGTH_ONLY), ripple={("unwind", 1): 3.0 + 1.0j})
    free.run(10.0)
    whole = complex(free.law.weight[0])
    cap_m = 0.5 * abs(whole)
    params = actuator(orders=(1,), drive=LENGTH_ONLY, shape=ShapeParams(weight_limit_m=cap_m))
    rig = Rig(params, ripple={("unwind", 1): 3.0 + 1.0j})
    rig.run(10.0)
    assert complex(rig.law.weight[0]) == pytest.approx(0.5 * whole, rel=0.05)


def test_a_limit_leaves_less_ripple_than_scaling_the_whole_and_the_shape_stays():
    """Behind a lag of 1 Hz the high orders cost more for less; they give way first."""
    ripple = {**RIPPLE, ("unwind", 3): 0.5 + 0.3j}
    free, tight = (
        Rig(actuator(orders=(1, 2, 3)), plant=LagDelay(GAIN_N_S_M, 2, 0.97), ripple=ripple)
        for _ in range(2)
    )
    free.run(10.0)
    tight.limit = 0.7 * free.last.peak_bound
    trace = tight.run(15.0)
    before = math.sqrt(sum(abs(c) ** 2 for c in ripple.values()) / 2)
    assert 0.95 * tight.limit < tight.last.peak_bound <= tight.limit
    assert tail_rms(trace) < 0.8 * 0.3 * before
    share = tight.law.allocation.share
    assert share[0] > share[1] > share[2]
    assert np.abs(tight.law.weight[:3]) == pytest.approx(np.abs(free.law.weight[:3]), rel=0.1)


def test_a_slew_limit_leaves_what_fits_and_does_not_shut_the_law():
    """Learning moves the weights fast at first; that alone must not take every order for good."""
    free = Rig(actuator(orders=(1, 2)), ripple=RIPPLE)
    free.run(8.0)
    tight = Rig(actuator(orders=(1, 2)), ripple=RIPPLE)
    tight.slew_limit = 0.02 * free.last.slew_bound
    tight.run(12.0)
    assert tight.last.slew_bound > 0.5 * tight.slew_limit


@settings(max_examples=5, deadline=None)
@given(size=st.floats(0.0, 50.0), seed=st.integers(0, 99))
def test_zero_gain_changes_nothing(size, seed):
    """Where P is known to be nothing, no ripple and no noise moves a weight or the output."""
    rig = Rig(known=LagDelay(0.0), ripple={k: size * c for k, c in RIPPLE.items()}, seed=seed)
    rig.noise_N = 0.3
    for _ in range(400):
        rig.tick()
        assert rig.u == 0.0
    assert not rig.law.weight.any()
    assert (rig.law.filter.response_ratio == 1.0).all()


def test_a_loop_that_does_not_answer_is_not_driven_harder_and_harder():
    """P is declared, the plant answers nothing: the output stays what noise alone makes."""
    rig = Rig(plant=LagDelay(0.0), known=LagDelay(GAIN_N_S_M, delay=2, lag=0.6))
    rig.noise_N = 0.25
    rig.run(8.0)
    assert rig.last.peak_bound < 2e-3


def test_a_drive_that_takes_no_correction_winds_nothing_up():
    """For 15 s nothing of what goes out reaches the drive; then all of it does again."""
    rig = Rig(ripple=RIPPLE)
    rig.noise_N = 0.1
    takes, rig.plant.gain = rig.plant.gain, 0.0
    rig.run(15.0)
    rests = np.flatnonzero(rig.law.monitor.resting)
    assert rests.size
    assert rig.law.states()[int(rests[0])] == OrderState.RISING
    rig.plant.gain = takes
    after = rig.run(45.0)
    assert np.abs(after).max() < 1.3 * sum(abs(c) for c in RIPPLE.values())
    assert tail_rms(after) < 0.1


def test_nothing_is_learned_without_permission_or_fresh_data():
    for kw in ({"adapt": False}, {"fresh": False}, {"signal": math.nan}, {"signal": 1e9}):
        rig = Rig(ripple=RIPPLE)
        rig.run(3.0, **kw)
        assert not rig.law.weight.any()
        assert rig.u == 0.0


def test_nothing_is_learned_without_excitation():
    """A roll that stands still turns no carrier."""
    rig = Rig(ripple=RIPPLE, omega=0.0)
    rig.run(5.0)
    assert not rig.law.weight.any()


def test_a_held_law_stays_held():
    rig = Rig(ripple=RIPPLE)
    rig.run(10.0)
    before, state = rig.law.weight.copy(), rig.law.filter.state.copy()
    rig.run(5.0, adapt=False)
    assert (rig.law.weight == before).all()
    assert (rig.law.filter.state == state).all()


@settings(max_examples=8, deadline=None)
@given(bad=st.lists(st.sampled_from([math.nan, math.inf, -math.inf, 1e300, 0.0]), min_size=1))
def test_nan_never_reaches_the_output(bad):
    rig = Rig(ripple=RIPPLE)
    rig.run(1.0)
    for value in bad:
        rig.tick(signal=value)
        unwind, theta = rig.phases["unwind"], rig.phases["unwind"].theta_rad
        unwind.omega_rad_s = value
        rig.tick()
        unwind.omega_rad_s, unwind.theta_rad = 5.0, theta
        assert math.isfinite(rig.last.value)
        assert math.isfinite(rig.last.peak_bound)
        assert math.isfinite(rig.last.slew_bound)


def test_a_weight_that_stops_being_a_number_is_never_sent_and_the_law_starts_anew():
    rig = Rig(ripple=RIPPLE)
    rig.run(2.0)
    rig.law.weight[0] = math.nan
    rig.tick()
    assert (rig.last.value, rig.last.peak_bound, rig.last.slew_bound) == (0.0, 0.0, 0.0)
    assert tail_rms(rig.run(14.0)) < 0.05


def test_a_saved_profile_starts_at_once():
    first = Rig(ripple=RIPPLE)
    first.noise_N = 0.1
    first.run(10.0)
    second = Rig(ripple=RIPPLE)
    second.noise_N = 0.1
    second.law.start_from(first.law.profile())
    assert (second.law.weight == first.law.weight).all()  # the imbalance's column too
    trace = second.run(6.0)
    assert tail_rms(trace, 4.0) < 0.05


def test_a_changed_roll_fades_without_a_jump_and_is_forgotten_the_other_roll_is_kept():
    params = actuator(orders=(1, 2), extra=(("swrap", (1,)),))
    rig = Rig(params, ripple={**RIPPLE, ("swrap", 1): 0.6 + 0.2j})
    rig.run(15.0)
    kept = rig.law.weights()[("swrap", 1)]
    outputs = [rig.u]
    rig.law.reset_roll("unwind")
    rig.ripple = {("swrap", 1): 0.6 + 0.2j}
    for _ in range(80):
        rig.tick()
        outputs.append(rig.u)
    assert np.abs(np.diff(outputs)).max() < 0.25 * np.abs(outputs).max()
    assert abs(rig.law.weights()[("unwind", 2)]) < 0.2e-3
    assert rig.law.weights()[("swrap", 1)] == pytest.approx(kept, rel=0.3)


def test_a_new_roll_is_learned_and_not_mistaken_for_harm():
    rig = Rig(ripple=RIPPLE)
    rig.noise_N = 0.1
    rig.run(12.0)
    rig.law.reset_roll("unwind")
    rig.ripple = {key: c * np.exp(1.9j) for key, c in RIPPLE.items()}
    trace = []
    for _ in range(round(25.0 / CYCLE_S)):
        trace.append(rig.tick())
        assert rig.law.monitor.calm
    assert tail_rms(np.array(trace), 15.0) < 0.05


def test_a_lost_angle_fades_its_columns_and_stops_learning():
    rig = Rig(ripple=RIPPLE)
    rig.run(10.0)
    rig.phases["unwind"].quality = Quality.LOST
    before = rig.law.weight.copy()
    rig.run(1.0)
    assert rig.u == 0.0
    assert (rig.law.weight == before).all()
    rig.phases["unwind"].quality = Quality.GOOD
    rig.run(1.0)
    assert abs(rig.u) > 0.0


def test_adopting_is_bumpless():
    rig = Rig(ripple=RIPPLE)
    rig.run(8.0)
    law = Rig(ripple=RIPPLE).law
    law.adopt(rig.law)
    assert (law.weight == rig.law.weight).all()
    before = rig.u
    rig.law = law
    law.basis._phases = [rig.phases["unwind"]] * len(law.basis._phases)
    law._own = rig.phases["unwind"]
    rig.tick()
    fastest = np.abs(law.weight * law.basis.b) @ law.basis.order * 5.0 * CYCLE_S
    assert abs(rig.u - before) <= 1.5 * fastest


def test_orders_above_the_fade_are_silent():
    rig = Rig(actuator(orders=(1, 30)), ripple={("unwind", 30): 1.0 + 0j})
    rig.run(10.0)
    assert abs(rig.law.basis.b[1]) == 0.0
    assert abs(rig.u) < 1e-3


def test_a_new_response_while_running_leaves_the_ripple_where_it_is():
    """What was learned of P was learned over the old one; kept as it is, it drives ripple up."""
    late = LagDelay(GAIN_N_S_M, delay=32, lag=0.6)
    rig = Rig(ripple=RIPPLE, known=late)
    rig.noise_N = 0.1
    learned = rig.run(40.0)
    assert tail_rms(learned) < 0.1
    right = Rig(rig.params).law
    right._own, right.basis._phases = rig.law._own, rig.law.basis._phases
    right.availability = rig.law.availability
    right.adopt(rig.law)
    rig.law = right
    assert np.std(rig.run(40.0)) < 0.1
    assert np.abs(right.filter.response_ratio_less_1[:2]).max() < 0.4


def test_orders_added_while_running_are_watched_at_once():
    rig = Rig(actuator(orders=(1,)), ripple=RIPPLE)
    rig.run(15.0)
    more = Rig(actuator(orders=(1, 2))).law
    more._own, more.basis._phases = rig.law._own, rig.law.basis._phases
    more.adopt(rig.law)
    rig.law = more
    rig.run(15.0)
    assert np.isfinite(more.monitor.now).all()
    assert more.ripple()[1] < 0.1 * more.ripple()[0]
