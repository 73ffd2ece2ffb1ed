"""Inertia and friction come back from noisy coast-downs with honest intervals."""

import numpy as np
import pytest

from sim_plant.identify.driven_roller import Run, coast_downs, fit_driven_roller, response
from sim_plant.identify.estimate import UndecidableError
from sim_plant.identify.roller_run import run_up_and_coast, simulate_roller, with_sensor

J, C, B = 0.35, 0.15, 0.01
NOISE, LSB = 5e-4, 2e-3


@pytest.fixture(scope="module")
def clean() -> Run:
    torque = run_up_and_coast(2.0, 4.0, 26.0, 0.01)
    return simulate_roller(
        inertia_kg_m2=J, constant_N_m=C, viscous_N_m_s=B, torque_N_m=torque, sample_time_s=0.01
    )


def noisy(run: Run, seed: int) -> Run:
    # the encoder of with_sensor, vectorised
    rng = np.random.default_rng(seed)
    speed = run.speed_rad_s + NOISE * rng.standard_normal(run.speed_rad_s.size)
    return Run(
        sample_time_s=run.sample_time_s,
        speed_rad_s=LSB * np.floor(speed / LSB + 0.5),
        torque_N_m=run.torque_N_m,
    )


def test_the_vectorised_sensor_is_the_elements_sensor(clean: Run) -> None:
    np.testing.assert_allclose(
        noisy(clean, 3).speed_rad_s, with_sensor(clean, NOISE, LSB, 3).speed_rad_s, atol=1e-12
    )


def test_closed_form_speed_obeys_the_torque_balance() -> None:
    run = Run(sample_time_s=1e-3, speed_rad_s=np.zeros(2001), torque_N_m=np.full(2001, 1.0))
    omega = response(run, J, C, B, 5.0)
    middle = 0.5 * (omega[2:] + omega[:-2])
    slope = (omega[2:] - omega[:-2]) / 2e-3
    np.testing.assert_allclose(J * slope, 1.0 - C - B * middle, atol=1e-6)


@pytest.mark.parametrize(
    ("count", "least"), [(20, 15), pytest.param(100, 90, marks=pytest.mark.long)]
)
def test_parameters_come_back_within_one_and_five_percent_and_intervals_cover(
    clean: Run, count: int, least: int
) -> None:
    """Of 20 intervals that cover nine times in ten, 15 do in 99 of 100 such draws."""
    fits = [fit_driven_roller([noisy(clean, seed)]) for seed in range(count)]
    for fit in fits:
        assert fit.inertia_kg_m2.value == pytest.approx(J, rel=0.01)
        assert fit.constant_N_m.value == pytest.approx(C, rel=0.05)
        assert fit.viscous_N_m_s.value == pytest.approx(B, rel=0.05)
    assert sum(fit.inertia_kg_m2.covers(J) for fit in fits) >= least
    assert sum(fit.constant_N_m.covers(C) for fit in fits) >= least
    assert sum(fit.viscous_N_m_s.covers(B) for fit in fits) >= least


def test_intervals_are_not_wide_for_nothing(clean: Run) -> None:
    fit = fit_driven_roller([noisy(clean, 1)])
    for found, truth in ((fit.inertia_kg_m2, J), (fit.constant_N_m, C), (fit.viscous_N_m_s, B)):
        assert (found.high - found.low) / truth < 0.02


def test_neglecting_friction_overstates_inertia_as_the_formula_says(clean: Run) -> None:
    # (2.29) gives J tau / (tau - c - b w_mean) to first order
    fit = fit_driven_roller([noisy(clean, 0)])
    mean_speed = 0.5 * float(np.max(clean.speed_rad_s))
    assert fit.nominal_inertia_kg_m2 == pytest.approx(
        J * 2.0 / (2.0 - C - B * mean_speed), rel=0.02
    )


def test_the_constant_term_improves_the_coast_down_fit(clean: Run) -> None:
    fit = fit_driven_roller([noisy(clean, 0)])
    assert fit.viscous_only_residual_rad_s > 100.0 * fit.residual_rad_s
    assert fit.viscous_only_N_m_s > 1.5 * B


def test_a_given_inertia_needs_only_the_coast_down(clean: Run) -> None:
    (coast,) = coast_downs(noisy(clean, 4))
    fit = fit_driven_roller([coast], inertia_kg_m2=J)
    assert fit.constant_N_m.value == pytest.approx(C, rel=0.01)
    assert fit.inertia_kg_m2.low == fit.inertia_kg_m2.high == J


def test_a_noisy_torque_signal_still_has_its_coast_down(clean: Run) -> None:
    run = noisy(clean, 5)
    hum = 0.002 * np.random.default_rng(5).standard_normal(run.torque_N_m.size)
    fit = fit_driven_roller(
        [Run(sample_time_s=0.01, speed_rad_s=run.speed_rad_s, torque_N_m=run.torque_N_m + hum)]
    )
    assert fit.inertia_kg_m2.value == pytest.approx(J, rel=0.01)
    assert fit.constant_N_m.value == pytest.approx(C, rel=0.05)
    assert fit.viscous_N_m_s.value == pytest.approx(B, rel=0.05)


def test_refuses_a_record_without_coast_down(clean: Run) -> None:
    powered = clean.torque_N_m > 0.0
    run = Run(
        sample_time_s=0.01,
        speed_rad_s=clean.speed_rad_s[powered],
        torque_N_m=clean.torque_N_m[powered],
    )
    with pytest.raises(UndecidableError, match="no coast-down"):
        fit_driven_roller([run])


def test_refuses_a_coast_down_alone_when_inertia_is_unknown(clean: Run) -> None:
    (coast,) = coast_downs(clean)
    with pytest.raises(UndecidableError, match=r"only c/J and b/J"):
        fit_driven_roller([coast])


def test_refuses_a_coast_down_that_hardly_slows(clean: Run) -> None:
    run = noisy(clean, 0)
    short = Run(
        sample_time_s=0.01, speed_rad_s=run.speed_rad_s[:600], torque_N_m=run.torque_N_m[:600]
    )
    with pytest.raises(UndecidableError, match="loses only"):
        fit_driven_roller([short])


def test_refuses_a_clipped_speed(clean: Run) -> None:
    run = noisy(clean, 0)
    top = 0.9 * float(np.max(run.speed_rad_s))
    clipped = Run(
        sample_time_s=0.01, speed_rad_s=np.minimum(run.speed_rad_s, top), torque_N_m=run.torque_N_m
    )
    with pytest.raises(UndecidableError, match="clipped"):
        fit_driven_roller([clipped])


def test_refuses_a_roller_at_rest() -> None:
    run = Run(sample_time_s=0.01, speed_rad_s=np.full(500, 0.2), torque_N_m=np.zeros(500))
    with pytest.raises(UndecidableError, match="never turns"):
        fit_driven_roller([run])
