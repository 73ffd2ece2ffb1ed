from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.search.free_terms import explained_by_free_term, free_term_basis
from sim_plant.refine.search.unexplained import Unknown
from sim_plant.refine.spectra.coordinates import RecordAxes, highest_order
from tests.each_case import each_case

LINE = load_declaration(Path(__file__).parents[4] / "config/lines/euclid.yaml")
TIME_S = np.arange(4000) * 0.01
SPEED = np.interp(TIME_S, [0.0, 15.0, 25.0, 40.0], [0.8, 0.8, 1.3, 1.3])
METRES = np.cumsum(SPEED) * 0.01
TURNS = METRES / (2.0 * np.pi * 0.2)
ANGLES = np.zeros((len(LINE.rollers), TIME_S.size))
ANGLES[0] = 2.0 * np.pi * TURNS
AXES = RecordAxes(
    declaration=LINE,
    sample_time_s=0.01,
    time_s=TIME_S,
    travel_m=METRES,
    angles_rad=ANGLES,
    speed_m_s=SPEED,
)


def left(basis, wave):
    return float(np.linalg.norm(wave - basis @ (basis.T @ wave)) / np.linalg.norm(wave))


def angle(order):
    return Unknown(
        unknown_class="angle",
        coordinate={"roll": LINE.rollers[0].name, "order": order},
        chi2_reduction=1.0,
    )


def test_columns_are_orthonormal():
    basis = free_term_basis([angle(1.0)], AXES)
    assert np.allclose(basis.T @ basis, np.eye(basis.shape[1]), atol=1e-9)


@pytest.mark.parametrize("order", [1, 3, 8])
@pytest.mark.sweep(every=3)
def test_a_roll_that_is_unknown_takes_all_its_orders_at_any_growth_with_speed(order):
    basis = free_term_basis([angle(4.0)], AXES)
    wave = SPEED**2 * np.cos(order * ANGLES[0] + 0.7)
    assert left(basis, wave) < 0.02


@pytest.mark.parametrize("order", [8.15, 20.0])
def test_a_line_between_or_above_the_low_orders_is_taken_itself(order):
    """0.15 of an order are five cycles over these 34 turns: more than slow changes reach."""
    basis = free_term_basis([angle(order)], AXES)
    assert left(basis, np.cos(order * ANGLES[0] + 0.7)) < 0.02


@pytest.mark.parametrize("order", [45.0, 47.3])
def test_a_line_near_the_end_of_an_angles_spectrum_is_taken(order):
    """Of words of 256 a turn up to 6 pass in 20 ms: by that the fastest turn is 13 % faster.

    The spectrum goes by rates over a second, to 0.98 of 50 Hz over 1.03 turns/s.
    """
    words = np.floor(256.0 * TURNS) / 256.0
    axes = replace(AXES, angles_rad=2.0 * np.pi * np.stack([words] * len(ANGLES)))
    assert order < highest_order(words, axes)
    basis = free_term_basis([angle(order)], axes)
    assert left(basis, np.cos(2.0 * np.pi * order * words + 0.7)) < 0.02


def test_slow_samples_have_low_orders_of_a_roll_taken_that_the_fastest_turns_fold():
    """Of 50 ms: half the sample rate is 10 Hz, and order 12 of the unwind is up to 12.4 Hz."""
    slow = replace(
        AXES,
        sample_time_s=0.05,
        time_s=TIME_S[::5],
        travel_m=METRES[::5],
        angles_rad=ANGLES[:, ::5],
        speed_m_s=SPEED[::5],
    )
    basis = free_term_basis([angle(12.0)], slow)
    assert left(basis, np.cos(12.0 * ANGLES[0][::5] + 0.7)) < 0.02


def test_what_stands_elsewhere_is_left_alone():
    basis = free_term_basis([angle(1.0)], AXES)
    assert left(basis, np.cos(2.0 * np.pi * 4.18 * METRES)) > 0.9
    share = basis.shape[1] / TIME_S.size  # of noise: as much as it has dimensions
    noise = np.random.default_rng(1).standard_normal(TIME_S.size)
    assert left(basis, noise) == pytest.approx(np.sqrt(1.0 - share), abs=0.01)


def test_a_line_that_crosses_a_resonance_is_taken():
    speed = np.interp(TIME_S, [0.0, 20.0, 40.0], [0.8, 1.3, 0.8])
    peak = 1.0 / (1.0 - (speed / 1.0) ** 2 + 0.2j * speed)
    wave = (peak * np.exp(4j * ANGLES[0])).real
    assert left(free_term_basis([angle(4.0)], AXES), wave) < 0.25


def test_a_wavenumber_a_quarter_bin_off_is_taken_all_the_same():
    off = 4.18 + 0.25 / float(np.ptp(METRES))
    item = Unknown(unknown_class="travel", coordinate={"wavenumber_1_m": off}, chi2_reduction=1.0)
    assert left(free_term_basis([item], AXES), np.cos(2.0 * np.pi * 4.18 * METRES)) < 0.1


def test_a_line_in_time_is_taken_in_time_only():
    item = Unknown(unknown_class="time", coordinate={"frequency_Hz": 3.4}, chi2_reduction=1.0)
    basis = free_term_basis([item], replace(AXES))
    assert left(basis, np.sin(2.0 * np.pi * 3.4 * TIME_S)) < 1e-6
    assert left(basis, np.cos(2.0 * np.pi * 3.4 * METRES)) > 0.9


def test_orders_of_one_roll_are_one_unknown():
    time = Unknown(unknown_class="time", coordinate={"frequency_Hz": 3.4}, chi2_reduction=1.0)
    other = Unknown(
        unknown_class="angle", coordinate={"roll": "rewind", "order": 1.0}, chi2_reduction=1.0
    )
    assert angle(4.0).same_roll_as(angle(1.0))
    assert not angle(1.0).same_roll_as(other)
    assert not time.same_roll_as(time)


R6_1_M = 1.0 / (2.0 * np.pi * LINE.rollers[LINE.body("R6")].radius_m)


@each_case(
    ("effect", "place", "choice", "line", "taken"),
    [
        ("torque_ripple", "unwind", {"order": 6}, angle(2.0), True),
        ("torque_ripple", "unwind", {"order": 24}, angle(24.0), True),
        ("torque_ripple", "unwind", {"order": 24}, angle(2.0), False),  # 16 orders are taken up
        ("torque_ripple", "unwind", {"order": 6}, angle(24.0), False),
        ("bearing_drag", "unwind", {}, angle(2.0), False),
        ("torque_ripple", "rewind", {"order": 6}, angle(2.0), False),
        ("unbalanced_roller", "R6", {}, ("travel", "wavenumber_1_m", R6_1_M), True),
        ("unbalanced_roller", "R6", {}, ("travel", "wavenumber_1_m", R6_1_M / 2.0), True),
        ("unbalanced_roller", "R6", {}, ("travel", "wavenumber_1_m", R6_1_M * 1.02), False),
        ("unbalanced_roller", "R6", {}, ("travel", "wavenumber_1_m", R6_1_M / 7.0), False),
        # 60 Hz sampled at 100 Hz shows at 40 Hz
        ("mains_hum", "R9", {"frequency_Hz": 60.0}, ("time", "frequency_Hz", 40.01), True),
        ("mains_hum", "R9", {"frequency_Hz": 60.0}, ("time", "frequency_Hz", 37.0), False),
        # hum stands in time: the turn of the roller under its cell says nothing of it
        ("mains_hum", "R15", {"frequency_Hz": 60.0}, ("travel", "wavenumber_1_m", R6_1_M), False),
        ("unbalanced_roller", "R6", {}, ("time", "frequency_Hz", 4.0), False),
    ],
)
def test_an_effect_at_the_line_of_a_free_term_is_not_searched(effect, place, choice, line, taken):
    unknown = line
    if isinstance(line, tuple):
        kind, name, at = line
        unknown = Unknown(unknown_class=kind, coordinate={name: float(at)}, chi2_reduction=1.0)
    h = hypothesis(BY_NAME[effect], place, tuple(choice.items()), line=LINE)
    assert explained_by_free_term(h, [unknown], AXES) is taken
