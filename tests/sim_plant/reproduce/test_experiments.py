"""What the slow experiments rest on: flow errors, S-wrap harmonics, P of both webs."""

import numpy as np
import pytest

from sim_plant.geometry.roll_profiles import flat_spot
from sim_plant.geometry.shapes import eccentric, ellipse
from sim_plant.reproduce.euclid import FPM_M_S, INCH_M, TENSION_N, open_euclid, set_torque, turned
from sim_plant.reproduce.experiments.eccentric_swrap import ripple
from sim_plant.reproduce.experiments.roll_feed_forward import response
from sim_plant.reproduce.experiments.supply import supply_of
from sim_plant.reproduce.plant_response import measure_response

IDLER_M = 1.5 * INCH_M


@pytest.mark.parametrize("length_m", [1.2, 0.4])
def test_arc_length_flow_errs_by_n_idler_radius_over_length(length_m: float) -> None:
    supply = supply_of(flat_spot(0.012, 8.0 * INCH_M), IDLER_M, length_m)
    found = [supply.harmonic_error(supply.arc_length, n) for n in (1, 2, 3, 4)]
    np.testing.assert_allclose(found, IDLER_M / length_m * np.arange(1, 5), rtol=5e-3)


def test_peripheral_speed_misses_an_ellipse_fourfold() -> None:
    supply = supply_of(ellipse(0.2062, 0.2002), IDLER_M, 0.9)
    assert supply.total_error(supply.peripheral) == pytest.approx(4.01, rel=0.02)


def test_eccentric_roller_error_of_arc_length_flow() -> None:
    supply = supply_of(eccentric(6.05 * INCH_M, 5e-4), IDLER_M, 0.9)
    assert supply.harmonic_error(supply.arc_length, 1) == pytest.approx(0.042, abs=5e-4)


def test_eccentric_swrap_makes_hardly_any_harmonics() -> None:
    phasors, _, _ = ripple(200.0 * FPM_M_S, coupled=True)
    sizes = np.abs(phasors)
    assert sizes[1] < 0.003 * sizes[0]
    assert sizes[2] < 0.001 * sizes[0]


@pytest.mark.parametrize(
    ("web", "angles_deg"), [("tyvek", (37, -21, -45, -69)), ("pe", (30, -60, -95, -117))]
)
@pytest.mark.sweep(every=2)
def test_plant_phase_at_the_rolls_orders(web: str, angles_deg: tuple[float, ...]) -> None:
    found = [np.degrees(np.angle(-response(web).at(n * 0.39789))) for n in (1, 2, 3, 4)]
    np.testing.assert_allclose(found, angles_deg, atol=6.0)


def test_printed_law_is_unstable_where_the_independent_model_says() -> None:
    edges = np.array([1.7, 1.85, 1.95, 2.1, 5.7, 5.95, 6.25, 6.5])
    plant = measure_response(
        lambda: open_euclid(speed_m_s=100.0 * FPM_M_S),
        "unwind",
        "unwind_tension_N",
        edges,
        100.0 * FPM_M_S,
        TENSION_N,
        duration_s=30.0,
    )
    unstable = np.abs(np.angle(-plant.values())) > 0.5 * np.pi
    # band 1.89-6.11 Hz
    np.testing.assert_array_equal(unstable, [False, False, True, True, True, True, False, False])


def test_torque_input_turns_the_follower() -> None:
    line = open_euclid(torque_input="swrap_follower", settle_s=10.0)
    before = line.readings()["true_swrap_follower_speed_m_s"]
    set_torque(line, 5.0)
    for _ in range(5):
        after = line.step({})["true_swrap_follower_speed_m_s"]
    assert after > before + 1e-3


def test_angle_of_a_linear_speed_is_its_parabola() -> None:
    time = 0.01 * np.arange(101)
    np.testing.assert_allclose(turned(3.0 * time, 0.01), 1.5 * time**2, atol=1e-12)
