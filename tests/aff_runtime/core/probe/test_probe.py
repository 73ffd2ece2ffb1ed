"""The probe on known plants, under ripple of two rolls and noise."""

import cmath
import math
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from aff_runtime.base.errors import RefusedError
from aff_runtime.base.signals import Permission
from aff_runtime.core.params import BlockParams, ProbeParams
from aff_runtime.core.probe.estimate import Tone, fit_delay, fit_tones
from aff_runtime.core.probe.excitation import LOUDEST, Waveform, log_grid, place_tones, step_Hz
from aff_runtime.core.probe.probe import Probe, Stage
from aff_runtime.core.response import Provenance, Response
from tests.aff_runtime.core.plants import (
    ACTUATOR,
    CYCLE_S,
    FREE,
    LagDelay,
    Line,
    site,
    snapshot,
    with_blocks,
)
from tests.aff_runtime.core.probe.noisy_line import BLOCKS, RIPPLE, noise

PARAMS = ProbeParams(
    actuators=("unwind",),
    amplitude=0.01,
    duration_s=25.0,
    f_max_Hz=6.0,
    louder_from_Hz=3.0,
    grid_points=10,
    max_speed_m_s=2.0,
)
ORIGIN = {n: Provenance(actuator=n, signal="tension_N") for n in ("unwind", "follower")}


def probed(plant, params=PARAMS, sigma=0.05):
    line = Line(plant, RIPPLE, seed_noise=noise(sigma))
    probe = Probe(site(with_blocks(BLOCKS)), params)
    line.run(probe, 32.0)
    assert probe.stage is Stage.DONE
    return probe


@pytest.mark.parametrize("plant", [(-400.0, 12, 0.96), (400.0, 30, 0.9)])
def test_recovers_a_known_response_under_ripple_and_noise(plant):
    (result,) = probed(LagDelay(*plant)).result(ORIGIN)
    low, high = result.response.band_Hz
    assert low < 5.0 / math.tau
    assert high > 4 * 5.0 / math.tau
    for f in (n * 5.0 / math.tau for n in (1, 2, 3, 4)):
        error = result.response.at(f) / LagDelay(*plant).at(f)
        assert abs(error) == pytest.approx(1.0, rel=0.02)
        assert abs(math.degrees(cmath.phase(error))) < 2.0
        assert result.response.phase_error_bound_rad(f) < math.radians(30)
    assert result.sign == math.copysign(1, plant[0])
    assert result.remarks == ()
    assert Response.from_json(result.response.to_json()).points == result.response.points


def test_standard_errors_are_honest():
    plant = LagDelay(-400.0, 12, 0.96)
    (result,) = probed(plant, sigma=1.0).result(ORIGIN)
    misses = [
        abs(cmath.rect(p.gain, p.phase_rad) / plant.at(p.frequency_Hz) - 1) / p.relative_error
        for p in result.response.points
    ]
    # |complex error| over its rms is about 1; three times it is rare
    assert 0.5 < math.sqrt(sum(m * m for m in misses) / len(misses)) < 1.8


def test_standard_errors_are_honest_where_tones_and_orders_stand_close():
    """Tones two turns of the record apart between orders of two rolls that drift."""
    time_s = np.arange(2000) * 0.01
    angles = [math.tau * (0.8 * time_s + 4e-4 * time_s**2), math.tau * 1.07 * time_s]
    tones = [
        Tone(omega_rad_s=math.tau * 0.1 * k, phase_rad=0.7 * k * k, amplitude=0.01)
        for k in range(4, 44, 2)
    ]
    P = 40.0 * np.exp(0.7j)
    sent = sum(t.amplitude * np.exp(1j * (t.omega_rad_s * time_s + t.phase_rad)) for t in tones)
    squares = []
    for seed in range(12):
        noise_N = np.random.default_rng(seed).standard_normal(time_s.size)
        fit = fit_tones(
            time_s=time_s,
            signal=(P * sent).real + noise_N,
            angles_rad=angles,
            nuisance_orders=6,
            own=tones,
            foreign=[],
        )
        squares += [
            (abs(cmath.rect(p.gain, p.phase_rad) - P) / (p.gain * p.relative_error)) ** 2
            for p in fit.points
        ]
    assert len(squares) > 200
    assert 0.9 < math.sqrt(np.mean(squares)) < 1.15


def test_excitation_never_exceeds_its_bound_and_starts_and_ends_at_zero():
    line, probe, sent = Line(LagDelay(-400.0), {}), Probe(site(with_blocks(BLOCKS)), PARAMS), []
    for _ in range(round(32 / CYCLE_S)):
        (step,) = probe.step(snapshot(line.tick, *line.read()), CYCLE_S, FREE)
        sent.append(step.value)
        change = abs(step.value - sent[-2]) if len(sent) > 1 else 0.0
        assert change <= step.slew_bound * CYCLE_S + 1e-12 or step.value == 0.0
        line.advance(step.value)
    assert max(map(abs, sent)) == pytest.approx(0.01)
    active = [v for v in sent if v != 0.0]
    assert abs(active[0]) < 2e-5
    assert abs(active[-1]) < 2e-5


def test_two_actuators_at_once_on_interleaved_tones():
    follower = replace(
        ACTUATOR,
        name="follower",
        signal="tension_ref_N",
        reference=None,
        blocks=(BlockParams(roll="swrap", orders=(1,), settle_s=8.0, amp_limit=0.02),),
    )
    first, second, cross = LagDelay(-400.0, 12, 0.96), LagDelay(150.0, 4, 0.8), LagDelay(80.0, 2)
    params = replace(PARAMS, actuators=("unwind", "follower"), grid_points=5)
    probe = Probe(site(with_blocks(BLOCKS), follower), params)
    permission = Permission(adapt=True, applied_ratio=(1.0, 1.0), limit_ratio=(1.0, 1.0))
    line, quiet, sent = Line(LagDelay(0.0), RIPPLE), noise(0.05), (0.0, 0.0)
    for _ in range(round(34 / CYCLE_S)):
        y, _, *rest = line.read()
        y1 = y + first.step(sent[0]) + cross.step(sent[1]) + quiet()
        y2 = 50.0 + second.step(sent[1]) + quiet()
        steps = probe.step(snapshot(line.tick, y1, y2, *rest), CYCLE_S, permission)
        sent = (steps[0].value, steps[1].value)
        line.advance(0.0)
    results = probe.result(ORIGIN)
    for result, omega_rad_s in zip(results, (line.omega, line.swrap_omega), strict=True):
        assert result.response.band_Hz[0] < omega_rad_s / math.tau
    for result, plant in zip(results, (first, second), strict=True):
        for p in result.response.points:
            error = cmath.rect(p.gain, p.phase_rad) / plant.at(p.frequency_Hz)
            assert abs(error - 1) < 0.03


def test_share_that_the_guard_lets_through_is_taken_into_account():
    plant = LagDelay(-400.0, 12, 0.96)
    line, probe = Line(plant, RIPPLE), Probe(site(with_blocks(BLOCKS)), PARAMS)
    share = Permission(adapt=True, applied_ratio=(0.8,), limit_ratio=(0.8,))
    for _ in range(round(32 / CYCLE_S)):
        (step,) = probe.step(snapshot(line.tick, *line.read()), CYCLE_S, share)
        line.advance(0.8 * step.value)
    (result,) = probe.result(ORIGIN)
    for p in result.response.points:
        assert p.gain == pytest.approx(abs(plant.at(p.frequency_Hz)), rel=0.01)


def test_lost_permission_aborts_to_zero():
    line, probe = Line(LagDelay(-400.0), {}), Probe(site(with_blocks(BLOCKS)), PARAMS)
    line.run(probe, 12.0)
    assert probe.stage is Stage.EXCITING
    withdrawn = Permission(adapt=False, applied_ratio=(0.0,), limit_ratio=(1.0,))
    line.run(probe, CYCLE_S, withdrawn)
    line.run(probe, 1.0)
    assert probe.stage is Stage.ABORTED
    assert line.u == 0.0
    with pytest.raises(RefusedError, match="permission"):
        probe.result(ORIGIN)


@pytest.mark.parametrize("cycle_s", [CYCLE_S, 4.0 * CYCLE_S])
def test_it_takes_as_long_as_it_says_whatever_the_cycle(cycle_s):
    params = replace(PARAMS, duration_s=15.0, grid_points=3)
    line, here = Line(LagDelay(-400.0), {}), replace(site(with_blocks(BLOCKS)), cycle_s=cycle_s)
    probe = Probe(here, params)
    taken_s = 0.0
    while probe.stage is not Stage.DONE:
        probe.step(snapshot(line.tick, *line.read()), cycle_s, FREE)
        for _ in range(round(cycle_s / CYCLE_S)):
            line.advance(0.0)
        taken_s += cycle_s
        assert taken_s < 60.0
    assert taken_s == pytest.approx(probe.expected_s, abs=0.3)


def test_record_full_of_holes_is_refused():
    line, probe = Line(LagDelay(-400.0), {}), Probe(site(with_blocks(BLOCKS)), PARAMS)
    line.run(probe, 6.0)
    for _ in range(27 * 200):
        values = (math.nan, *line.read()[1:])
        (step,) = probe.step(snapshot(line.tick, *values), CYCLE_S, FREE)
        line.advance(step.value)
    with pytest.raises(
        RefusedError, match=r"0% of readings can be used.* every 5 ms \(cycle_ms\)"
    ):
        probe.result(ORIGIN)


def test_spread_keeps_its_distance_on_whole_steps():
    tones = place_tones([1.0, 1.0, 1.05, 2.0], [1.0, 2.01], 0.1, 0.05)
    everything = sorted([*tones, 1.0, 2.01])
    assert len(tones) == 4
    assert all(b - a >= 0.1 - 1e-9 for a, b in pairwise(everything))
    assert [f / 0.05 for f in tones] == pytest.approx([round(f / 0.05) for f in tones])


def test_log_grid_has_equal_ratios():
    assert log_grid(1.0, 8.0, 4) == pytest.approx([1, 2, 4, 8])
    assert log_grid(0.0, 8.0, 4) == []


def filled(tones_Hz, cycle_s=CYCLE_S, louder_from_Hz=100.0):
    """Return a wave of 20 s that is ready, and its samples at a peak of 1."""
    wave = Waveform(round(20.0 / cycle_s), cycle_s)
    wave.plan(tones_Hz, 1.0, louder_from_Hz)
    while not wave.fill():
        assert wave.sample(1000, 1.0) == 0.0
    return wave, np.array([wave.sample(k, 1.0) for k in range(round(20.0 / cycle_s))])


@pytest.mark.parametrize("cycle_s", [0.005, 0.003])
def test_tones_that_stand_in_octaves_have_a_peak_of_little_more_than_twice_their_rms(cycle_s):
    tones = place_tones(log_grid(0.1, 19.0, 40), [], 0.075, step_Hz(cycle_s))
    wave, sent = filled(tones, cycle_s)
    assert np.abs(sent).max() <= 1.0
    assert wave.amplitude(1.0) * math.sqrt(0.5 * len(tones)) > 1.0 / 2.3


def test_what_goes_out_is_the_sum_of_the_tones_that_are_told():
    wave, sent = filled([0.5, 1.3, 2.4])
    time_s = np.arange(sent.size) * CYCLE_S
    told = sum(
        size * wave.amplitude(1.0) * np.cos(omega * time_s + phase)
        for omega, phase, size in wave.tones
    )
    assert sent[200:-200] == pytest.approx(told[200:-200], abs=1e-12)


def test_fast_tones_are_louder_and_the_sum_keeps_the_peak():
    _, sent = filled([2.0, 3.6, 12.0], louder_from_Hz=3.0)
    assert np.abs(sent).max() == pytest.approx(1.0, abs=0.02)
    # 2, 3.6 and 12 Hz are whole bins of the 10 s in its middle
    spectrum = np.abs(np.fft.rfft(sent[1000:3000]))
    assert spectrum[[36, 120]] / spectrum[20] == pytest.approx([1.2, LOUDEST], rel=1e-3)


def test_a_ripple_that_grows_does_not_spoil_the_tone_beside_it():
    """An order at 1.0 Hz grows by a fifth in the record; tones 0.15 Hz from it and its double."""
    time_s = np.arange(4000) * CYCLE_S
    theta = math.tau * time_s
    tones = [Tone(omega_rad_s=math.tau * f, phase_rad=0.3, amplitude=0.01) for f in (1.15, 2.15)]
    P = 40.0 * np.exp(0.7j)
    signal = sum(
        (P * t.amplitude * np.exp(1j * (t.omega_rad_s * time_s + t.phase_rad))).real for t in tones
    )
    signal = signal + (1.0 + 0.01 * time_s) * (3.0 * np.cos(theta) + np.sin(2.0 * theta))
    fit = fit_tones(
        time_s=time_s, signal=signal, angles_rad=[theta], nuisance_orders=2, own=tones, foreign=[]
    )
    assert fit.strange == ()
    for point in fit.points:
        assert cmath.rect(point.gain, point.phase_rad) == pytest.approx(P, rel=1e-6)
        assert point.relative_error < 1e-6


IDLER_HZ = 3.55


def strange(idler_N, wander_rad=0.0, seed=3):
    """Return the fit of 28 tones of 0.05 N under an idler that nobody declared, and the true P."""
    return made_strange(idler_N, wander_rad, seed)


@cache  # three tests look at the same records
def made_strange(idler_N, wander_rad, seed):
    rng = np.random.default_rng(seed)
    time_s = np.arange(4000) * CYCLE_S
    theta = math.tau * 0.88 * time_s  # its order 4 is at 3.52 Hz, half a bin from the idler
    P = LagDelay(-400.0, 12, 0.96)
    tones = [
        Tone(omega_rad_s=math.tau * f, phase_rad=0.7 * k * k, amplitude=0.05 / abs(P.at(f)))
        for k, f in enumerate(
            place_tones(log_grid(0.5, 8.0, 28), [0.88 * n for n in range(1, 10)], 0.075, 0.01875)
        )
    ]
    signal = rng.normal(0.0, 0.25, time_s.size) + 2.0 * np.cos(theta + 0.4)
    slow = wander_rad * np.cos(math.tau * 0.11 * time_s)
    signal += idler_N * np.cos(math.tau * IDLER_HZ * time_s + 1.0 + slow)
    for t in tones:
        sent = t.amplitude * np.exp(1j * (t.omega_rad_s * time_s + t.phase_rad))
        signal += (P.at(t.omega_rad_s / math.tau) * sent).real
    fit = fit_tones(
        time_s=time_s, signal=signal, angles_rad=[theta], nuisance_orders=9, own=tones, foreign=[]
    )
    return fit, P


def misses(fit, P):
    """Return |error of P| over its standard error, by frequency."""
    return {
        p.frequency_Hz: abs(cmath.rect(p.gain, p.phase_rad) / P.at(p.frequency_Hz) - 1)
        / p.relative_error
        for p in fit.points
    }


@pytest.mark.parametrize("wander_rad", [0.0, 0.1])
@pytest.mark.sweep(every=2)
def test_ripple_of_a_roll_that_nobody_declared_does_not_spoil_the_tones_around_it(wander_rad):
    fit, P = strange(1.0, wander_rad=wander_rad)
    quiet, _ = strange(0.0)
    assert any(abs(line.frequency_Hz - 3.55) < 0.2 for line in fit.strange)
    near = [p for p in fit.points if 2.0 < p.frequency_Hz < 5.0]
    usual = [p.relative_error for p in quiet.points]
    assert len(near) >= 4
    assert max(p.relative_error for p in near) < 2.5 * max(usual)
    bound = Response(points=fit.points, delay_s=fit_delay(fit.points), provenance=ORIGIN["unwind"])
    assert bound.phase_error_bound_rad(3.55) < math.radians(60.0)
    assert abs(cmath.phase(bound.at(3.55) / P.at(3.55))) < bound.phase_error_bound_rad(3.55)


@pytest.mark.parametrize("wander_rad", [0.0, 0.1])
@pytest.mark.sweep(every=2)
def test_standard_errors_are_as_honest_beside_ripple_that_nobody_declared(wander_rad):
    beside, without = (
        [m for s in range(4) for m in misses(*strange(N, wander_rad=wander_rad, seed=s)).values()]
        for N in (1.0, 0.0)
    )
    rms, usual = (math.sqrt(sum(m * m for m in found) / len(found)) for found in (beside, without))
    assert rms < 1.1 * usual


def test_a_tone_right_beside_strange_ripple_is_left_out():
    fit, _ = strange(1.0)
    frequencies = [p.frequency_Hz for p in strange(0.0)[0].points]
    lost = set(frequencies) - {p.frequency_Hz for p in fit.points}
    assert lost
    assert all(abs(f - 3.55) < 0.5 for f in lost)


def test_noise_alone_is_no_strange_ripple():
    assert all(strange(0.0, seed=s)[0].strange == () for s in range(6))


def test_a_technician_hears_of_ripple_that_no_roll_of_the_site_has():
    line = Line(LagDelay(-400.0, 12, 0.96), RIPPLE, seed_noise=noise(0.05))
    alone = replace(site(with_blocks(BLOCKS)), rolls=site().rolls[:1])
    probe = Probe(alone, PARAMS)
    line.run(probe, 32.0)
    (result,) = probe.result(ORIGIN)
    (remark,) = result.remarks
    assert "belongs to no roll of the site file; declare that roll and probe again" in remark


@pytest.mark.parametrize(("every", "begins"), [(10, True), (1, False)])
def test_a_missing_sample_now_and_then_does_not_begin_the_listening_anew(every, begins):
    line, probe = Line(LagDelay(-400.0, 12, 0.96), {}), Probe(site(with_blocks(BLOCKS)), PARAMS)
    for tick in range(round(1.25 * PARAMS.listen_s / CYCLE_S)):
        there = tick < 20 or tick % every != 0
        probe.step(snapshot(tick, *line.read(), fresh=there), CYCLE_S, FREE)
        line.advance(0.0)
    assert (probe.stage > Stage.LISTENING) is begins
