"""How loud a probe is: by the noise, within its bounds, and never beyond them."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from aff_runtime.core.params import ProbeParams
from aff_runtime.core.probe.choosing import Choosing
from aff_runtime.core.probe.excitation import Waveform
from aff_runtime.core.probe.loud import FIRST_SHARE, ROOM, Heard, allowed, peak_of, unbiased
from aff_runtime.core.probe.probe import Probe, Stage
from aff_runtime.core.probe.quiet import QuietWindow
from aff_runtime.core.response import Provenance
from tests.aff_runtime.core.plants import (
    CYCLE_S,
    FREE,
    LagDelay,
    Line,
    site,
    snapshot,
    with_blocks,
)
from tests.aff_runtime.core.probe.noisy_line import BLOCKS, RIPPLE, noise

HERE = site(with_blocks(BLOCKS))
PARAMS = ProbeParams(
    actuators=("unwind",),
    amplitude=0.02,
    f_max_Hz=6.0,
    louder_from_Hz=3.0,
    grid_points=10,
    max_speed_m_s=2.0,
    is_chosen=True,
)
ABOUT = {"unwind": Provenance(actuator="unwind", signal="tension_N", line_speed_m_s=1.0)}
GAIN = -400.0
LONGEST_S = 160.0


def probed(line, params=PARAMS, former=None):
    """Run a probe to its end; return it, and what it sent."""
    probe, sent = Probe(HERE, params, former), []
    for _ in range(round(LONGEST_S / CYCLE_S)):
        (step,) = probe.step(snapshot(line.tick, *line.read()), CYCLE_S, FREE)
        assert abs(step.value) <= step.peak_bound + 1e-12
        assert abs(step.value) <= params.amplitude * (1 + 1e-9)
        if sent:
            is_over = step.value == 0.0 and abs(sent[-1]) < 0.011 * params.amplitude  # of a fade
            assert is_over or abs(step.value - sent[-1]) <= step.slew_bound * CYCLE_S + 1e-9
        sent.append(step.value)
        line.advance(step.value)
        if probe.stage in (Stage.DONE, Stage.ABORTED):
            break
    return probe, sent


@cache
def first_of(sigma):
    """Return a probe of a line with so much noise that came to its end."""
    probe, _ = probed(quiet_line(sigma))
    assert probe.stage is Stage.DONE, probe.reason
    return probe


def quiet_line(sigma, gain=GAIN):
    return Line(LagDelay(gain, 12, 0.96), RIPPLE, seed_noise=noise(sigma))


def test_twice_the_noise_wants_twice_the_amplitude():
    """Noise is in the same places twice as large, so that what is needed of tones is so, too."""
    sent = {}
    for sigma in (0.02, 0.04):
        (result,) = first_of(sigma).result(ABOUT)
        sent[sigma] = result.response.provenance.amplitude
    assert sent[0.04] / sent[0.02] == pytest.approx(2.0, rel=0.25)
    assert sent[0.02] < PARAMS.amplitude


@pytest.mark.parametrize("sigma", [0.04, 0.1])
@pytest.mark.sweep(every=2)
def test_what_is_chosen_gives_the_error_that_was_wanted(sigma):
    """Nine tenths of the orders' tones are to be known to a fifth; the fit says what they are."""
    (result,) = first_of(sigma).result(ABOUT)
    assert result.response.provenance.amplitude < PARAMS.amplitude
    low_Hz = 0.6 * 5.0 / math.tau
    errors = [p.relative_error for p in result.response.points if p.frequency_Hz >= low_Hz]
    assert 0.07 < np.quantile(errors, 0.9) < 0.3


def test_with_a_former_response_it_takes_no_steps_and_says_how_far_the_two_are_apart():
    (first,) = first_of(0.04).result(ABOUT)
    again, sent = probed(
        Line(LagDelay(GAIN, 12, 0.96), RIPPLE, seed_noise=noise(0.04, seed=6)),
        former={"unwind": first.response},
    )
    (second,) = again.result(ABOUT)
    assert math.isnan(first.response.provenance.repeat_sigmas)
    assert 0.6 < second.response.provenance.repeat_sigmas < 1.4
    loud = np.flatnonzero(sent)
    assert (loud[-1] - loud[0]) * CYCLE_S == pytest.approx(PARAMS.duration_s, abs=0.1)
    other = {"unwind": replace(ABOUT["unwind"], line_speed_m_s=2.0)}
    (elsewhere,) = again.result(other)
    assert math.isnan(elsewhere.response.provenance.repeat_sigmas)


def test_a_former_response_of_another_speed_is_not_believed():
    elsewhere = {"unwind": replace(ABOUT["unwind"], line_speed_m_s=1.5)}
    (first,) = first_of(0.04).result(elsewhere)
    _, sent = probed(quiet_line(0.04), former={"unwind": first.response})
    begin = np.flatnonzero(sent)[0]
    early = np.abs(sent[begin : begin + round(10.0 / CYCLE_S)])
    assert early.max() == pytest.approx(PARAMS.amplitude / 16, rel=0.05)


def test_it_rises_from_a_small_part_of_its_bound():
    """2 N of noise, 8 N at the bound: too faint at a sixteenth, heard at a quarter of it."""
    probe, sent = probed(quiet_line(2.0))
    assert probe.stage is Stage.DONE
    size = np.abs(sent)
    first = np.flatnonzero(size)[0]
    early = size[first : first + round(10.0 / CYCLE_S)]
    assert early.max() == pytest.approx(PARAMS.amplitude / 16, rel=0.05)
    assert probe.result(ABOUT)[0].response.provenance.amplitude > 2 * PARAMS.amplitude / 16


def test_what_cannot_be_heard_within_the_bound_says_what_would_be_needed():
    probe, _ = probed(quiet_line(6.0, gain=-40.0))
    assert probe.stage is Stage.ABORTED
    assert "not heard within its bound" in probe.reason
    assert "probe.bound_m_s" in probe.reason


def test_the_tones_keep_within_the_room_of_the_tension():
    """The line answers 400 N per m/s: 20 mm/s would be 8 N, and 1 N is what may be."""
    bound_N = 1.0
    line = quiet_line(0.8)
    probe, sent = probed(line, replace(PARAMS, bound_N=bound_N))
    assert probe.stage is Stage.DONE, probe.reason
    moved_N = answer_N(sent)
    assert np.abs(moved_N).max() < bound_N
    assert np.abs(moved_N).max() > 0.4 * bound_N
    (result,) = probe.result(ABOUT)
    (remark,) = result.remarks
    assert "would be needed" in remark
    assert "raise probe.bound_N" in remark


def answer_N(sent):
    """Return what the plant without noise and ripple makes of what was sent."""
    plant = LagDelay(GAIN, 12, 0.96)
    return np.array([plant.step(u) for u in sent])


class Stronger(LagDelay):
    """A plant that answers five times as strong from some sample on."""

    def __init__(self, *plant, after):
        super().__init__(*plant)
        self.left = after

    def step(self, u):
        self.left -= 1
        return super().step(u if self.left > 0 else 5.0 * u)


def test_a_line_that_answers_more_than_was_thought_ends_the_probe_at_the_bound():
    bound_N = 1.5
    former = {"unwind": first_of(0.02).result(ABOUT)[0].response}
    plant = Stronger(GAIN, 12, 0.96, after=0)
    line = Line(plant, RIPPLE, seed_noise=noise(0.02))
    params = replace(PARAMS, bound_N=bound_N, louder_than=0.02)
    again, sent = probed(line, params, former)
    assert again.stage is Stage.ABORTED
    assert "tension_N moved" in again.reason
    assert "the bound is 1.5" in again.reason
    assert sent[-1] == 0.0
    begin = np.flatnonzero(sent)[0]
    assert (len(sent) - begin) * CYCLE_S < 3.0
    late = 5.0 * answer_N(sent)
    # the ripple was 4.9 N at most in the quiet stretch; the tones add to it, not to its peak alone
    assert np.abs(late).max() < bound_N + 2 * 4.9
    tail = np.abs(sent[-round(0.5 / CYCLE_S) :])
    assert tail.max() > 0.0


def test_a_speed_that_wanders_ends_the_probe_with_both_speeds():
    line = quiet_line(0.05)
    probe = Probe(HERE, replace(PARAMS, is_chosen=False, amplitude=0.005))
    sent = []
    for tick in range(round(40.0 / CYCLE_S)):
        if tick > round(12.0 / CYCLE_S):
            line.omega = 5.0 * 1.08  # line speed 1.00 to 1.08 m/s
        (step,) = probe.step(snapshot(line.tick, *line.read()), CYCLE_S, FREE)
        sent.append(step.value)
        line.advance(step.value)
    assert probe.stage is Stage.ABORTED
    assert "the line speed went from 1 to 1.05 m/s" in probe.reason
    assert sent[-1] == 0.0


def test_a_small_change_of_speed_ends_nothing():
    line = quiet_line(0.05)
    probe = Probe(HERE, replace(PARAMS, is_chosen=False, amplitude=0.005))
    line.run(probe, 12.0)
    line.omega = 5.0 * 1.03
    line.run(probe, 25.0)
    assert probe.stage is Stage.DONE


def test_noise_is_told_beside_ripple_of_known_rolls():
    """White noise of sigma in N samples: E|n|^2 of an amplitude is 4 sigma^2 / N."""
    samples, sigma = 2000, 0.3
    rng = np.random.default_rng(3)
    told = []
    for _ in range(12):
        window = QuietWindow(samples, CYCLE_S, signals=1, angles=1, orders=6)
        angle = 5.03 * np.arange(samples) * CYCLE_S
        for one, n in zip(angle, rng.standard_normal(samples) * sigma, strict=True):
            window.take([50.0 + 4.0 * math.cos(one) + 2.0 * math.sin(3 * one) + n], [one])
        assert window.is_full
        work = window.weigh()
        while not next(work):
            pass
        told.append(window.noise(0, np.array([15, 40, 90, 200])).mean())
    assert np.mean(told) == pytest.approx(4.0 * sigma**2 / samples, rel=0.15)


def test_a_window_with_too_many_holes_tells_nothing():
    window = QuietWindow(1000, CYCLE_S, signals=1, angles=1, orders=2)
    for k in range(1000):
        window.take([math.nan if k % 3 == 0 else 1.0], [0.01 * k])
    work = window.weigh()
    while not next(work):
        pass
    assert np.isnan(window.noise(0, np.array([50]))).all()


def test_readings_that_come_every_second_tick_choose_nothing_and_nothing_is_sent():
    line, probe, sent = quiet_line(0.05), Probe(HERE, PARAMS), []
    for tick in range(round(30.0 / CYCLE_S)):
        told = snapshot(line.tick, *line.read(), fresh=tick % 2 == 0)
        (step,) = probe.step(told, CYCLE_S, FREE)
        sent.append(step.value)
        line.advance(step.value)
    assert probe.stage is Stage.ABORTED
    assert "cycle_ms" in probe.reason
    assert not any(sent)


def test_readings_that_are_lost_in_a_step_end_it_at_zero():
    line, probe, sent = quiet_line(0.05), Probe(HERE, PARAMS), []
    for tick in range(round(60.0 / CYCLE_S)):
        is_lost = probe.stage is Stage.RISING and tick % 2 == 0
        told = snapshot(line.tick, *line.read(), fresh=not is_lost)
        (step,) = probe.step(told, CYCLE_S, FREE)
        assert math.isfinite(step.value)
        sent.append(step.value)
        line.advance(step.value)
    assert probe.stage is Stage.ABORTED
    assert "cycle_ms" in probe.reason
    assert max(map(abs, sent)) > 0.0
    assert sent[-1] == 0.0


def test_what_moves_a_signal_too_far_is_turned_down_for_all_waves_alike():
    moved = np.array([[100.0, 50.0], [0.0, 400.0]])
    found = allowed([0.02, 0.01], moved, [10.0, 2.0])
    assert found == pytest.approx([0.02 * ROOM * 2.0 / 4.0, 0.01 * ROOM * 2.0 / 4.0])
    assert allowed([0.02, 0.01], moved, [math.inf, math.inf]) == [0.02, 0.01]


def test_the_needed_peak_follows_from_gain_and_noise():
    """|P| 100, tone 0.25 of the peak, noise 0.05 N: an error of 0.2 wants 0.01."""
    count = 10
    heard = Heard(
        sizes=np.full(count, 0.25),
        answers=np.full(count, 100.0 + 0.0j),
        noise=np.full(count, 0.05**2),
        counts=np.ones(count, dtype=bool),
    )
    assert heard.needed() == pytest.approx(0.05 / (0.2 * 100.0 * 0.25))
    assert heard.least() == pytest.approx(0.05 / (0.61 * 100.0 * 0.25))
    assert heard.sure(0.9 * heard.least()) == 0
    assert heard.sure(1.1 * heard.least()) == count


def test_noise_alone_passes_for_no_answer():
    rng = np.random.default_rng(1)
    noise_alone = (rng.standard_normal(40) + 1j * rng.standard_normal(40)) / math.sqrt(2.0)
    assert np.mean(unbiased(noise_alone, np.ones(40)) == 0.0) > 0.9
    seen = 5.0 * np.exp(1j * np.arange(40)) + noise_alone
    assert np.abs(unbiased(seen, np.ones(40))).mean() == pytest.approx(5.0, rel=0.1)


def test_the_peak_of_two_tones_that_meet_is_their_sum():
    found = peak_of(np.array([1.0, 2.0 + 0j]), np.array([3, 7]), 1000)
    assert found == pytest.approx(3.0)


def test_what_is_held_in_the_middle_of_a_fade_stays_as_loud_as_it_is():
    wave = Waveform(round(PARAMS.duration_s / CYCLE_S), CYCLE_S)
    wave.plan([1.0, 2.0, 3.0], PARAMS.fade_s, PARAMS.louder_from_Hz)
    while not wave.fill():
        pass
    choosing = Choosing(HERE, PARAMS, HERE.actuators[:1], [wave], {})
    choosing.begin_steps()
    half = round(0.5 * PARAMS.fade_s / CYCLE_S)
    for _ in range(half):
        choosing.sound(1, [0.0], [0.0] * len(HERE.rolls))
    choosing.hold()
    period = round(10.0 / CYCLE_S)
    sent = [choosing.sound(1, [0.0], [0.0] * len(HERE.rolls))[0].value for _ in range(period)]
    assert max(map(abs, sent)) == pytest.approx(0.5 * FIRST_SHARE * PARAMS.amplitude, rel=0.02)
