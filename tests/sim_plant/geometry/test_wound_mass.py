import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.geometry.roll_profiles import flat_spot
from sim_plant.geometry.shapes import circle, eccentric, ellipse
from sim_plant.geometry.wound_mass import WoundMass, gravity_torque_N_m, wound_mass

WEB = {"core_radius_m": 0.04, "density_kg_m3": 400.0, "width_m": 0.15}


def test_round_roll_has_the_annulus_formulas() -> None:
    found = wound_mass(circle(0.2), **WEB)
    assert found.mass_kg == pytest.approx(60.0 * np.pi * (0.2**2 - 0.04**2), rel=1e-13)
    assert found.inertia_kg_m2 == pytest.approx(30.0 * np.pi * (0.2**4 - 0.04**4), rel=1e-13)
    assert found.offset_m == pytest.approx(0.0, abs=1e-16)


def test_eccentric_roll_follows_from_parallel_axes() -> None:
    found = wound_mass(eccentric(0.2, 0.003, 0.8), **WEB)
    outer = np.pi * 0.2**2
    area = outer - np.pi * 0.04**2
    assert found.offset_m == pytest.approx(0.003 * outer / area, rel=1e-12)
    assert found.offset_angle_rad == pytest.approx(0.8, abs=1e-12)
    polar = 0.5 * np.pi * (0.2**4 - 0.04**4) + outer * 0.003**2
    assert found.inertia_kg_m2 == pytest.approx(60.0 * polar, rel=1e-12)


def test_elliptical_roll_has_the_textbook_moment() -> None:
    found = wound_mass(ellipse(0.21, 0.19), **WEB)
    polar = 0.25 * np.pi * 0.21 * 0.19 * (0.21**2 + 0.19**2) - 0.5 * np.pi * 0.04**4
    assert found.inertia_kg_m2 == pytest.approx(60.0 * polar, rel=1e-12)


def test_flat_spot_moves_the_centre_of_gravity_to_the_other_side() -> None:
    # circular segment: area R^2 (b - sin b cos b), first moment 2/3 R^3 sin^3 b
    radius, half = 0.2, np.arccos(1.0 - 0.012 / 0.2)
    segment = radius**2 * (half - np.sin(half) * np.cos(half))
    area = np.pi * (radius**2 - 0.04**2) - segment
    found = wound_mass(flat_spot(0.012, radius, angle_rad=0.5), **WEB)
    wanted = 2.0 / 3.0 * (radius * np.sin(half)) ** 3 / area
    assert found.offset_m == pytest.approx(wanted, rel=0.06)  # smoothing rounds the corners
    assert found.offset_angle_rad == pytest.approx(0.5 - np.pi, abs=1e-9)
    assert found.mass_kg == pytest.approx(60.0 * area, rel=1e-3)


def test_smoothed_roll_agrees_with_the_polygon_formulas() -> None:
    shape = flat_spot(0.012, 0.2, angle_rad=0.5)
    here = shape.boundary(np.linspace(0.0, 2.0 * np.pi, 100000, endpoint=False))
    there = np.roll(here, -1)
    cross = (np.conj(here) * there).imag
    area = 0.5 * np.sum(cross) - np.pi * 0.04**2
    first = np.sum((here + there) * cross) / 6.0
    square = np.abs(here) ** 2 + np.abs(there) ** 2 + (np.conj(here) * there).real
    polar = np.sum(square * cross) / 12.0 - 0.5 * np.pi * 0.04**4
    found = wound_mass(shape, **WEB)
    assert found.mass_kg == pytest.approx(60.0 * area, rel=1e-8)
    assert found.offset_m == pytest.approx(abs(first) / area, rel=1e-6)
    assert found.inertia_kg_m2 == pytest.approx(60.0 * polar, rel=1e-8)


@pytest.mark.parametrize("rotation", [1, -1])
def test_gravity_does_the_work_of_lowering_the_centre_of_gravity(rotation: int) -> None:
    mass = WoundMass(mass_kg=5.0, offset_m=0.003, offset_angle_rad=0.4, inertia_kg_m2=0.1)

    def height_m(theta: float) -> float:
        return mass.offset_m * float(np.sin(rotation * (theta + mass.offset_angle_rad)))

    for theta in (0.0, 1.0, 2.7, 5.0):
        slope = (height_m(theta + 1e-6) - height_m(theta - 1e-6)) / 2e-6
        found = gravity_torque_N_m(mass, theta, rotation)
        assert found == pytest.approx(-5.0 * 9.80665 * slope, abs=1e-9)


def test_core_larger_than_the_profile_is_refused() -> None:
    with pytest.raises(PlantError, match="does not fit"):
        wound_mass(eccentric(0.05, 0.02), **WEB)
