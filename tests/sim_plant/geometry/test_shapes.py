import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import ellipe

from aff_runtime.base.errors import PlantError
from sim_plant.geometry.roll_profiles import flat_spot
from sim_plant.geometry.shapes import Shape, circle, eccentric, ellipse, orders

PSI = np.linspace(0.0, 2.0 * np.pi, 8192, endpoint=False)

low_orders = st.lists(
    st.tuples(st.integers(1, 6), st.floats(0.0, 1e-3), st.floats(-np.pi, np.pi, allow_nan=False)),
    min_size=1,
    max_size=4,
)


def chord_length_m(shape: Shape) -> float:
    outline = shape.boundary(PSI)
    return float(np.sum(np.abs(np.roll(outline, -1) - outline)))


@given(low_orders)
@settings(max_examples=25, deadline=None)
def test_perimeter_is_two_pi_mean_radius(rows: list[tuple[int, float, float]]) -> None:
    shape = orders(0.2, rows)
    assert chord_length_m(shape) == pytest.approx(2.0 * np.pi * 0.2, rel=3e-7)
    assert shape.perimeter_m == pytest.approx(2.0 * np.pi * np.mean(shape.evaluate(PSI)[0]))


@given(low_orders, st.floats(-7.0, 7.0), st.floats(-7.0, 7.0))
@settings(max_examples=25, deadline=None)
def test_turning_a_shape_shifts_its_angle(
    rows: list[tuple[int, float, float]], angle_rad: float, psi_rad: float
) -> None:
    shape = orders(0.2, rows)
    turned = np.array(shape.turned(angle_rad).evaluate(psi_rad + angle_rad))
    assert turned == pytest.approx(np.array(shape.evaluate(psi_rad)), abs=1e-14)


def test_slope_and_curvature_are_derivatives_of_the_support() -> None:
    shape = orders(0.2, [(1, 1e-3, 0.4), (3, 5e-4, -1.0), (5, 1e-4, 2.0)])
    step = 1e-4
    before, here, after = (shape.evaluate(PSI + k * step) for k in (-1, 0, 1))
    assert here[1] == pytest.approx((after[0] - before[0]) / (2 * step), abs=1e-9)
    bend = (after[0] - 2 * here[0] + before[0]) / step**2
    assert here[2] == pytest.approx(here[0] + bend, abs=1e-7)


def test_ellipse_matches_its_equation_and_the_elliptic_integral() -> None:
    a, b = 0.205, 0.199
    shape = ellipse(a, b)
    outline = shape.boundary(PSI)
    assert (outline.real / a) ** 2 + (outline.imag / b) ** 2 == pytest.approx(1.0, abs=1e-12)
    assert shape.perimeter_m == pytest.approx(4.0 * a * ellipe(1.0 - (b / a) ** 2), rel=1e-13)


def test_eccentric_outline_is_a_shifted_circle() -> None:
    outline = eccentric(0.15, 0.002, angle_rad=0.7).boundary(PSI)
    assert np.abs(outline - 0.002 * np.exp(0.7j)) == pytest.approx(0.15, abs=1e-15)


def test_winding_adds_the_same_length_along_every_normal() -> None:
    shape = orders(0.1, [(2, 2e-3, 0.3), (3, 1e-3, 0.0)])
    grown = shape.at_radius(0.15).boundary(PSI) - shape.boundary(PSI)
    assert grown == pytest.approx(0.05 * np.exp(1j * PSI), abs=1e-15)


def test_smoothing_rounds_corners_and_keeps_perimeter_and_convexity() -> None:
    sharp = flat_spot(0.012, 0.2)
    soft = sharp.smoothed(np.radians(2.0))
    assert soft.perimeter_m == sharp.perimeter_m
    assert soft.is_convex
    # a Gaussian average of the support function
    offsets = np.linspace(-0.3, 0.3, 4001)
    weight = np.exp(-0.5 * (offsets / np.radians(2.0)) ** 2)
    average = np.sum(sharp.evaluate(0.1 + offsets)[0] * weight) / np.sum(weight)
    assert soft.evaluate(0.1)[0] == pytest.approx(average, abs=1e-10)


def test_least_convex_radius_is_where_the_curvature_measure_touches_zero() -> None:
    # rho = R + (1 - n^2) a cos(n psi): zero at R = 3 a for order 2
    shape = orders(0.2, [(2, 0.004, 0.0)])
    assert shape.least_convex_radius_m == pytest.approx(0.012, rel=1e-6)
    assert shape.is_convex
    assert not shape.at_radius(0.0119).is_convex


def test_shape_that_no_web_can_follow_is_refused_with_the_radius_it_needs() -> None:
    with pytest.raises(PlantError, match=r"it is from 0\.3 m on"):
        orders(0.2, [(2, 0.1, 0.0)])


@pytest.mark.parametrize("radius_m", [0.0, -0.1, float("nan")])
def test_radius_that_is_not_positive_is_refused(radius_m: float) -> None:
    with pytest.raises(PlantError, match="mean radius"):
        circle(radius_m)


def test_order_out_of_range_is_refused() -> None:
    with pytest.raises(PlantError, match=r"1\.\.256"):
        orders(0.2, [(257, 1e-6, 0.0)])
