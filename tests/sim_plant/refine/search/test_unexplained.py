"""When what is left is called broadband, which channels count, and what kind a line is of."""

import numpy as np
import pytest

from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.fit.objective import conditioned_on
from sim_plant.refine.fit.whitening import Whitening
from sim_plant.refine.noise.innovations import noise_model
from sim_plant.refine.search.coherence import least_likely_coupling
from sim_plant.refine.search.completeness import remaining_spectra
from sim_plant.refine.search.unexplained import kept_by_noise, loudest, periodic_left, what_is_left
from sim_plant.refine.spectra.coordinates import spectra
from tests.sim_plant.refine.small import (
    STEP_S,
    axes_at,
    fit_of,
    formula_twin,
    line_with,
    objective_of,
    one_peak,
    white,
)

UNEXPLAINED = CRITERIA.search.unexplained
SAMPLES, JUDGED = 6000, 4500
RECORD_AXES = [axes_at(np.ones(JUDGED))]
ANALOGUE = ("unwind_tension_N", "rewind_speed_rad_s", "rewind_tension_N")
WITH_WORD = ("unwind_tension_N", "unwind_angle_rad", "rewind_tension_N")


def objective_with(channels):
    twin = formula_twin(lambda _: np.zeros((3, SAMPLES)), channels, SAMPLES)
    return objective_of(twin, white((3, SAMPLES)))


OBJECTIVE, COARSE = objective_with(ANALOGUE), objective_with(WITH_WORD)


def band_limited(low_Hz, high_Hz):
    """Return noise of rms 1 within a band (judged samples,)."""
    spectrum = np.fft.rfft(white(JUDGED, 5))
    at = np.fft.rfftfreq(JUDGED, STEP_S)
    spectrum[(at < low_Hz) | (at > high_Hz)] = 0.0
    values = np.fft.irfft(spectrum, JUDGED)
    return values / values.std()


def left(sizes=(1.0, 1.0, 1.0), push=0.0):
    """Return a fit that leaves noise of these sizes, and a push on the last two channels."""
    part = np.asarray(sizes)[:, None] * white((3, JUDGED), seed=4)
    part[1:] += push * band_limited(3.0, 4.5)
    residual = np.append(part.ravel(), np.zeros(len(OBJECTIVE.nuisances)))
    return fit_of(residual=residual, cost=float(residual @ residual))


def parts(objective, fit):
    return what_is_left(objective, fit, fit, RECORD_AXES, one_peak())


def power(objective, fit):
    return loudest(objective.whitening, objective.split(fit.residual))


def test_the_loudest_channel_counts_and_a_coarse_word_does_not():
    assert power(COARSE, left((1.0, 3.0, 1.2))) == pytest.approx(1.44, rel=0.1)
    assert power(COARSE, left((1.0, 3.0, 1.0))) < UNEXPLAINED.loud
    assert power(OBJECTIVE, left((1.0, 3.0, 1.0))) == pytest.approx(9.0, rel=0.1)


def swings(seed, size):
    """Return noise (3, SAMPLES), in the last channel with slow swings of this size."""
    noise = white((3, SAMPLES), seed)
    spectrum = np.fft.rfft(white(SAMPLES, seed + 100))
    at = np.fft.rfftfreq(SAMPLES, STEP_S)
    spectrum[(at < 0.5) | (at > 3.0)] = 0.0
    slow = np.fft.irfft(spectrum, SAMPLES)
    noise[2] += size * slow / slow.std()
    return noise


@pytest.mark.parametrize(("size", "loud"), [(2.0, False), (6.0, True)])
def test_noise_that_swings_in_some_runs_and_not_in_others_is_no_cause(size, loud):
    """A record that swings as one run in three does is beyond 1.12 of white noise, and noise."""
    runs = np.stack([swings(seed, 2.0 * (seed % 3 == 0)) for seed in range(10, 22)])
    declared = noise_model(runs, SAMPLES - JUDGED, np.zeros(3))
    record = swings(30, size)
    noise = declared.adjusted_to(record)
    whitening = Whitening(
        realisations=(runs,), declared=(declared,), noise=(noise,), basis=(None,)
    )
    left = noise.whiten(record)
    assert np.max(np.mean(left**2, axis=1)) > UNEXPLAINED.loud
    assert bool(loudest(whitening, [left]) > UNEXPLAINED.loud) is loud


def test_a_channel_whose_noise_is_declared_too_loud_is_judged_by_the_record():
    """Seeded runs twice as loud as the record keep no more when they are weighed as it is."""
    runs = 2.0 * white((12, 3, SAMPLES), 8)
    declared = noise_model(runs, SAMPLES - JUDGED, np.zeros(3))
    noise = declared.adjusted_to(white((3, SAMPLES), 9))
    whitening = Whitening(
        realisations=(runs,), declared=(declared,), noise=(noise,), basis=(None,)
    )
    assert kept_by_noise(whitening)[0] == pytest.approx(np.ones(3), abs=0.05)


@pytest.mark.parametrize(("size", "kinds"), [(1.0, []), (1.15, ["broadband"])])
def test_broadband_is_claimed_for_a_channel_that_is_clearly_loud(size, kinds):
    found = parts(OBJECTIVE, left((1.0, 1.0, size)))
    assert [u.unknown_class for u in found] == kinds
    assert all(not u.coordinate for u in found)


@pytest.mark.parametrize(("push", "kinds"), [(0.1, []), (0.3, ["broadband"])])
def test_channels_that_move_together_as_no_noise_does_are_broadband(push, kinds):
    fit = left(push=push)
    assert power(OBJECTIVE, fit) < UNEXPLAINED.loud
    odd = least_likely_coupling(OBJECTIVE, fit).score > UNEXPLAINED.coupled
    found = parts(OBJECTIVE, fit)
    assert odd is bool(kinds)
    assert [u.unknown_class for u in found] == kinds
    assert all("rewind_speed_rad_s and rewind_tension_N" in u.text for u in found)
    slow = np.cos(np.pi * (np.arange(JUDGED) + 0.5) / JUDGED)[:, None]
    beside = conditioned_on(OBJECTIVE, [slow / np.linalg.norm(slow)])
    assert parts(beside, fit) == []  # beside a free line, what it leaves is coupled


@pytest.mark.parametrize(("chi2_reduction", "kinds"), [(250.0, []), (300.0, ["time"])])
def test_a_line_is_claimed_above_what_healthy_records_show(chi2_reduction, kinds):
    fit = left()
    found = what_is_left(OBJECTIVE, fit, fit, RECORD_AXES, one_peak(chi2_reduction))
    assert [u.unknown_class for u in found] == kinds
    assert all(u.coordinate == {"frequency_Hz": 1.0} for u in found)


@pytest.mark.parametrize(("objective", "channels"), [(OBJECTIVE, 3), (COARSE, 2)])
def test_free_lines_are_sought_in_channels_with_noise_of_their_own(objective, channels):
    spectra = remaining_spectra(objective, left(), RECORD_AXES)
    assert {s.degrees for s in spectra[0]} == {2 * channels}  # cos and sin each, one speed


def begun(shape):
    """Return what is left, and its spectra, of what has this shape from 20 s on, 0 before."""
    time_s = STEP_S * np.arange(JUDGED)
    part = white((3, JUDGED), seed=6)
    part[0] += np.where(time_s > 20.0, shape(time_s), 0.0)
    residual = np.append(part.ravel(), np.zeros(len(OBJECTIVE.nuisances)))
    fit = fit_of(residual=residual, cost=float(residual @ residual))
    return fit, remaining_spectra(OBJECTIVE, fit, RECORD_AXES)


@pytest.mark.parametrize(
    ("shape", "kinds"),
    [
        (lambda t: 4.0 * np.sin(2.0 * np.pi * 3.0 * t), ("time", "travel")),
        (lambda t: np.full(t.shape, 3.0), ("event",)),
    ],
    ids=["a resonance", "a step"],
)
def test_what_a_speed_brings_to_sound_is_a_line_and_a_step_is_an_event(shape, kinds):
    fit, spectra = begun(shape)
    found = what_is_left(OBJECTIVE, fit, fit, RECORD_AXES, spectra)
    assert [u.unknown_class in kinds for u in found] == [True]


@pytest.mark.parametrize(
    ("sizes", "where"),
    [
        ((0.5, 0.0, 0.2), {"zone": "unwind_zone", "channel": "unwind_tension_N"}),
        ((0.2, 0.9, 0.5), {"zone": "rewind_zone", "channel": "rewind_tension_N"}),
        ((0.5, 0.0, 0.5), {}),
    ],
    ids=["unwind", "rewind", "both alike"],
)
def test_a_line_in_time_names_the_zone_in_which_it_is_strongest(sizes, where):
    """By load cells alone: a drive between two zones answers to both."""
    speed_m_s = np.where(np.arange(JUDGED) < JUDGED // 2, 0.8, 1.3)
    axes = axes_at(speed_m_s)
    wave = np.cos(2.0 * np.pi * 6.2 * axes.time_s)
    part = np.asarray(sizes)[:, None] * wave
    part += white((3, JUDGED), seed=9)
    residual = np.append(part.ravel(), np.zeros(len(OBJECTIVE.nuisances)))
    fit = fit_of(residual=residual, cost=float(residual @ residual))
    (found,) = what_is_left(OBJECTIVE, fit, fit, [axes], [spectra(axes, part)])
    assert (found.unknown_class, found.also) == ("time", ())
    coordinate = dict(found.coordinate)
    assert coordinate.pop("frequency_Hz") == pytest.approx(6.2, rel=3e-3)
    assert coordinate == where


def left_of(wave, speed_m_s):
    """Return the spectra of what is left, a wave in noise, of a record at these speeds."""
    axes = axes_at(speed_m_s)
    part = white((3, JUDGED), seed=9) + wave(axes)
    return tuple(spectra(axes, part))


def in_time(axes):
    return 0.5 * np.cos(2.0 * np.pi * 6.2 * axes.time_s)


def in_travel(axes):
    return 0.5 * np.cos(2.0 * np.pi * 6.2 * axes.travel_m)


SLOW, FAST, RAMP = np.full(JUDGED, 0.8), np.full(JUDGED, 1.3), np.linspace(0.8, 1.3, JUDGED)


@pytest.mark.parametrize("wave", [in_time, in_travel])
@pytest.mark.parametrize("speed_m_s", [SLOW, FAST])
def test_at_one_speed_a_line_in_time_may_be_one_in_travel_or_at_an_angle(wave, speed_m_s):
    """The wavenumber is f / v, the order f over the turns in a second; no record tells them."""
    spectra_left = left_of(wave, speed_m_s)
    found = periodic_left([spectra_left], 1000.0)
    kinds = {found.unknown_class: found.coordinate, **dict(found.also)}
    assert set(kinds) == {"time", "travel", "angle"}
    speed = float(speed_m_s[0])
    frequency_Hz = 6.2 if wave is in_time else 6.2 * speed
    assert kinds["time"]["frequency_Hz"] == pytest.approx(frequency_Hz, rel=3e-3)
    assert kinds["travel"]["wavenumber_1_m"] == pytest.approx(frequency_Hz / speed, rel=3e-3)
    orders = [
        dict(where) for kind, where in [(found.unknown_class, found.coordinate), *found.also]
    ]
    at = {w["roll"]: w["order"] for w in orders if "roll" in w}
    radius_m = {r.name: r.radius_m for r in line_with().rollers}
    for roll, order in at.items():
        turns_1_s = speed / (2.0 * np.pi * radius_m[roll])
        assert order == pytest.approx(frequency_Hz / turns_1_s, rel=3e-3)
    assert set(at) == {"unwind", "rewind"}


@pytest.mark.parametrize(
    ("wave", "kind"), [(in_time, "time"), (in_travel, "travel")], ids=["time", "travel"]
)
@pytest.mark.parametrize("speeds", [(RAMP,), (SLOW, FAST)], ids=["a ramp", "two records"])
def test_two_speeds_tell_a_line_in_time_from_one_in_travel(wave, kind, speeds):
    found = periodic_left([left_of(wave, speed) for speed in speeds], 1000.0)
    kinds = {found.unknown_class, *(other for other, _ in found.also)}
    assert ("time" in kinds) is (kind == "time")
    assert ("travel" in kinds) is (kind == "travel")
