"""Idler friction from multi-speed line records: truth recovered, divisor explained, refusals."""

from pathlib import Path

import numpy as np
import pytest

from sim_plant.base.arrays import Array
from sim_plant.identify.estimate import UndecidableError
from sim_plant.identify.idler_friction import (
    Plateau,
    fit_idler_friction,
    plateaus,
    rollers_between_cells,
    steady_stretches,
)
from sim_plant.line.open import make_line
from sim_plant.line.reading.load import load_declaration

LINE = load_declaration(Path(__file__).parents[3] / "config" / "lines" / "euclid.yaml")
C, B, RADIUS = 0.017219, 0.0001429, 0.0381
SPEEDS = np.array([100.0, 150.0, 200.0, 250.0, 300.0, 350.0]) * 0.00508
NOISE, LSB = 0.25, 0.05
ROWS = 5000
NAMES = ("line_speed_m_s", "unwind_tension_N", "r3_tension_N")


@pytest.fixture(scope="module")
def clean() -> list[dict[str, Array]]:
    found = []
    for speed in SPEEDS:
        line = make_line(LINE, seed=None, speed_m_s=float(speed))
        line.settle(10.0)
        rows = line.simulate(np.full(ROWS, speed), np.full(ROWS, 88.9644))
        found.append({name: rows["true_" + name] for name in NAMES})
    return found


def points(records: list[dict[str, Array]], seed: int) -> list[Plateau]:
    rng = np.random.default_rng(seed)

    def cell(force: Array) -> Array:
        return LSB * np.floor((force + NOISE * rng.standard_normal(force.size)) / LSB + 0.5)

    time = 0.005 * np.arange(ROWS)
    return [
        plateau
        for r in records
        for plateau in plateaus(
            time, r[NAMES[0]], cell(r[NAMES[1]]), cell(r[NAMES[2]]), RADIUS, settle_s=1.0
        )
    ]


@pytest.mark.parametrize("count", [20, pytest.param(100, marks=pytest.mark.long)])
def test_both_coefficients_come_back_and_intervals_cover(
    clean: list[dict[str, Array]], count: int
) -> None:
    divisor = rollers_between_cells(5)
    fits = [fit_idler_friction(points(clean, seed), RADIUS, divisor) for seed in range(count)]
    for fit in fits:
        assert fit.constant_N_m.value == pytest.approx(C, rel=0.05)
        assert fit.viscous_N_m_s.value == pytest.approx(B, rel=0.05)
    assert sum(fit.constant_N_m.covers(C) for fit in fits) >= 0.9 * count
    assert sum(fit.viscous_N_m_s.covers(B) for fit in fits) >= 0.9 * count


@pytest.mark.long  # quick: both coefficients, above
def test_a_line_run_with_its_own_sensors_in_the_loop_gives_the_same() -> None:
    found = []
    for number, speed in enumerate(SPEEDS):
        line = make_line(LINE, seed=number, speed_m_s=float(speed))
        line.settle(20.0)
        r = line.simulate(np.full(5000, speed), np.full(5000, 88.9644))
        found += plateaus(
            0.005 * np.arange(5000), r[NAMES[0]], r[NAMES[1]], r[NAMES[2]], RADIUS, settle_s=1.0
        )
    fit = fit_idler_friction(found, RADIUS, rollers_between_cells(5))
    assert fit.constant_N_m.value == pytest.approx(C, rel=0.05)
    assert fit.viscous_N_m_s.value == pytest.approx(B, rel=0.05)


def test_the_printed_divisor_makes_torques_one_seventh_too_small(
    clean: list[dict[str, Array]],
) -> None:
    exact = points(clean, 0)
    six = fit_idler_friction(exact, RADIUS, 6.0)
    seven = fit_idler_friction(exact, RADIUS, 7.0)
    assert seven.constant_N_m.value == pytest.approx(six.constant_N_m.value * 6.0 / 7.0)
    assert not seven.constant_N_m.covers(C)


def test_several_plateaus_in_one_record_are_found_apart() -> None:
    time = 0.01 * np.arange(9000)
    speed = np.select([time < 30.0, time < 60.0], [0.5, 1.0], 1.5)
    stretches = steady_stretches(time, speed)
    assert stretches == [(0, 3000), (3000, 6000), (6000, 9000)]


def test_refuses_one_speed_only(clean: list[dict[str, Array]]) -> None:
    same = points(clean[:1], 0) + points(clean[:1], 1) + points(clean[:1], 2)
    with pytest.raises(UndecidableError, match="one speed only"):
        fit_idler_friction(same, RADIUS, 6.0)


def test_refuses_speeds_too_close_together() -> None:
    close = [
        Plateau(omega_rad_s=w, tension_drop_N=3.0 + 0.01 * w, standard_error_N=0.01)
        for w in (20.0, 21.0, 22.0)
    ]
    with pytest.raises(UndecidableError, match="span only"):
        fit_idler_friction(close, RADIUS, 6.0)


def test_refuses_exchanged_cells(clean: list[dict[str, Array]]) -> None:
    swapped = [
        Plateau(
            omega_rad_s=p.omega_rad_s,
            tension_drop_N=-p.tension_drop_N,
            standard_error_N=p.standard_error_N,
        )
        for p in points(clean, 0)
    ]
    with pytest.raises(UndecidableError, match="exchanged"):
        fit_idler_friction(swapped, RADIUS, 6.0)


@pytest.mark.parametrize("above_N", [0.3, -5.0])
def test_refuses_a_clipped_cell(clean: list[dict[str, Array]], above_N: float) -> None:
    r = clean[0]
    noise = NOISE * np.random.default_rng(0).standard_normal(5000)
    ripple = 2.0 * np.sin(0.005 * np.arange(5000))
    force = np.minimum(r[NAMES[1]] + noise + ripple, r[NAMES[1]].mean() + above_N)
    with pytest.raises(UndecidableError, match="clipped"):
        plateaus(0.005 * np.arange(5000), r[NAMES[0]], force, r[NAMES[2]], RADIUS)


def test_refuses_a_line_that_is_never_steady() -> None:
    time = 0.01 * np.arange(3000)
    rng = np.random.default_rng(0)
    force = 90.0 + rng.standard_normal(3000)
    with pytest.raises(UndecidableError, match="steady nowhere"):
        plateaus(time, 0.1 + 0.1 * time, force, force - 3.0, RADIUS)
