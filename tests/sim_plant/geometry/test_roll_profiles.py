import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.geometry.convex_hull import jackson_weights
from sim_plant.geometry.extrema import radius_cubic
from sim_plant.geometry.roll_profiles import (
    asymmetric,
    bulge,
    flat_spot,
    flattened_bulge,
    from_extrema,
    insert_outline,
    wooden_insert,
)
from sim_plant.geometry.shapes import Shape

INCH = 0.0254
R = 8.0 * INCH
PROFILES = {
    "flat spot": flat_spot(0.012, R),
    "bulge": bulge(0.005, R),
    "asymmetric": asymmetric(0.006, R),
    "flattened bulge": flattened_bulge(0.005, 0.05, R),
    "wooden insert": wooden_insert(5.5 * INCH, 3.0 * INCH, 0.5 * INCH, R),
    "measured": from_extrema([(0.0, R), (0.6, R + 0.004), (2.0, R - 0.003), (4.5, R + 0.001)]),
}


@pytest.mark.parametrize("name", PROFILES)
def test_curvature_measure_is_nowhere_negative(name: str) -> None:
    *_, rho = PROFILES[name].evaluate(np.linspace(0.0, 2.0 * np.pi, 20000))
    assert float(np.min(rho)) > -1e-9


@pytest.mark.parametrize(
    ("name", "percent"), [("flat spot", -0.22), ("bulge", 0.23), ("asymmetric", 0.33)]
)
def test_mean_radius_differs_from_the_round_radius(name: str, percent: float) -> None:
    # physics.md, caveat (iv)
    assert 100.0 * (PROFILES[name].mean_radius_m / R - 1.0) == pytest.approx(percent, abs=0.005)


def test_flat_spot_orders_match_the_closed_form() -> None:
    # rho = R outside |psi| < beta, and the edge 2 R sin(beta) as a spike at 0
    half = np.arccos(1.0 - 0.012 / R)
    n = np.arange(2, 257)
    exact = 2.0 * R / np.pi * (np.sin(half) - np.sin(n * half) / n) / (1.0 - n * n)
    first = R / np.pi * (half * np.cos(half) - np.sin(half))
    wanted = np.concatenate([[first], exact]) * jackson_weights(256)
    assert PROFILES["flat spot"].deviation_m == pytest.approx(wanted, abs=2e-9)
    assert PROFILES["flat spot"].mean_radius_m == pytest.approx(
        R + R / np.pi * (np.sin(half) - half), abs=2e-9
    )


def test_smoothing_kernel_is_nowhere_negative() -> None:
    kernel = np.fft.irfft(np.concatenate([[1.0], jackson_weights(256), np.zeros(3840)]))
    assert float(np.min(kernel)) > -1e-15


def test_smoothing_acts_like_a_narrow_gaussian() -> None:
    n = np.arange(1, 21)
    gaussian = np.exp(-0.5 * (n * np.radians(0.7)) ** 2)
    assert jackson_weights(256)[:20] == pytest.approx(gaussian, abs=2e-3)


def test_position_angle_turns_the_flat_spot() -> None:
    turned = flat_spot(0.012, R, angle_rad=1.1)
    psi = np.linspace(0.0, 2.0 * np.pi, 6001)
    lowest = psi[int(np.argmin(turned.evaluate(psi)[0]))]
    assert lowest == pytest.approx(1.1, abs=2e-3)


def test_insert_outline_has_the_printed_dimensions() -> None:
    outline = insert_outline(5.5 * INCH, 3.0 * INCH, 0.5 * INCH) / INCH
    at_edge = outline[np.argmin(np.abs(outline - (1.5 + 6.0j)))]
    assert at_edge == pytest.approx(1.5 + 6.0j, abs=1e-12)  # (4.40) as printed: 3.97 in
    assert np.max(np.abs(np.diff(outline, append=outline[0]))) < 3.01  # the flat; no other gap
    assert np.max(outline.imag) == pytest.approx(6.0)
    assert np.min(outline.real) == pytest.approx(-5.5)
    assert np.min(outline.imag) == pytest.approx(-5.5, abs=1e-6)


def test_wound_insert_keeps_its_flat_top_and_round_back() -> None:
    roll = PROFILES["wooden insert"]
    top, back = roll.evaluate(np.array([0.0, np.pi]))[0]
    assert top - back == pytest.approx(0.5 * INCH, abs=1e-3)  # smoothing lifts the flat's middle
    bare_radius_m = roll.mean_radius_m - (back - 5.5 * INCH)
    with pytest.raises(PlantError, match="smaller than its insert"):
        wooden_insert(5.5 * INCH, 3.0 * INCH, 0.5 * INCH, bare_radius_m - 1e-4)


def test_flattened_bulge_edge_stands_at_its_height() -> None:
    support, *_ = PROFILES["flattened bulge"].evaluate(np.array([0.0, np.pi]))
    assert support[0] - support[1] == pytest.approx(0.005, abs=3e-4)


def test_cubic_passes_its_extrema_with_zero_slope() -> None:
    extrema = [(5.0, 0.21), (0.5, 0.2), (2.0, 0.205)]
    radius, slope = radius_cubic(extrema, np.array([0.5, 2.0, 5.0, 1.25]))
    assert radius == pytest.approx([0.2, 0.205, 0.21, 0.2025], abs=1e-15)
    assert slope[:3] == pytest.approx(0.0, abs=1e-15)
    assert slope[3] == pytest.approx(1.5 * 0.005 / 1.5)


def test_cubic_slope_is_the_derivative_of_its_radius() -> None:
    extrema = [(5.0, 0.21), (0.5, 0.2), (2.0, 0.205)]
    angles = np.linspace(-1.0, 7.0, 37)
    low, _ = radius_cubic(extrema, angles - 1e-6)
    high, _ = radius_cubic(extrema, angles + 1e-6)
    assert radius_cubic(extrema, angles)[1] == pytest.approx((high - low) / 2e-6, abs=1e-7)


@pytest.mark.parametrize(
    ("extrema", "reason"),
    [
        ([(0.0, 0.2)], "at least two"),
        ([(0.0, 0.2), (2.0 * np.pi, 0.21)], "same angle"),
        ([(0.0, 0.2), (1.0, -0.2)], "positive"),
    ],
)
def test_unusable_extrema_are_refused(extrema: list[tuple[float, float]], reason: str) -> None:
    with pytest.raises(PlantError, match=reason):
        from_extrema(extrema)


@pytest.mark.parametrize("depth_m", [-0.001, 0.3])
def test_flat_spot_deeper_than_the_roll_is_refused(depth_m: float) -> None:
    with pytest.raises(PlantError, match="depth"):
        flat_spot(depth_m, R)


def test_hull_bridges_a_hollow_that_the_web_cannot_enter() -> None:
    hollow: Shape = from_extrema([(0.0, 0.2), (0.3, 0.19), (0.6, 0.2), (3.7, 0.2)])
    # the web spans the two shoulders; smoothing lifts the kink by half a millimetre
    angles = np.linspace(0.0, 0.6, 10001)
    radius, _ = radius_cubic([(0.0, 0.2), (0.3, 0.19), (0.6, 0.2), (3.7, 0.2)], angles)
    bridge_m = np.max(radius * np.cos(angles - 0.3))
    assert bridge_m > 0.1930
    assert bridge_m < hollow.evaluate(0.3)[0] < bridge_m + 8e-4
