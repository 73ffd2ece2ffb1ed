import numpy as np
import pytest

from sim_plant.geometry.extrema import radius_cubic
from sim_plant.geometry.shapes import Floats, circle, ellipse
from sim_plant.geometry.source_convex import ConvexLine, convex_span, tangent_slope
from sim_plant.geometry.tangent import Body, common_tangent
from tests.sim_plant.geometry.brute_force import polygon_tangent

A, B = 0.206, 0.2


def ellipse_radius(phi: Floats) -> tuple[Floats, Floats]:
    square = (B * np.cos(phi)) ** 2 + (A * np.sin(phi)) ** 2
    slope = -A * B * (A * A - B * B) * np.sin(phi) * np.cos(phi) / square**1.5
    return A * B / np.sqrt(square), slope


def cubic_radius(phi: Floats) -> tuple[Floats, Floats]:
    return radius_cubic([(0.2, 0.2), (1.6, 0.203), (3.5, 0.199), (5.0, 0.202)], phi)


@pytest.mark.parametrize("over_wrap", [True, False])
def test_minimised_tangent_agrees_with_the_exact_one(over_wrap: bool) -> None:
    line = ConvexLine(
        radius=ellipse_radius, distance_m=1.0, idler_radius_m=0.0381, over_wrap=over_wrap
    )
    a = Body(center_x_m=0.0, center_y_m=0.0, rotation=-1, shape=ellipse(A, B))
    sigma = -1 if over_wrap else 1
    b = Body(center_x_m=1.0, center_y_m=0.0, rotation=sigma, shape=circle(0.0381))
    thetas = np.linspace(0.0, 2.0 * np.pi, 17)
    span = common_tangent(a, b, -thetas, 0.0)
    found = [convex_span(line, float(theta))[0] for theta in thetas]
    assert [s.length_m for s in found] == pytest.approx(span.length_m, abs=1e-8)


@pytest.mark.parametrize("over_wrap", [True, False])
def test_cubic_profile_agrees_with_a_taut_string(over_wrap: bool) -> None:
    line = ConvexLine(
        radius=cubic_radius, distance_m=1.0, idler_radius_m=0.0381, over_wrap=over_wrap
    )
    dense = np.linspace(0.0, 2.0 * np.pi, 100000, endpoint=False)
    outline = cubic_radius(dense)[0] * np.exp(1j * dense)
    idler = 1.0 + 0.0381 * np.exp(1j * dense)
    for theta in (0.0, 1.0, 2.5, 4.0):
        roll = outline * np.exp(1j * theta)
        i, j = polygon_tangent(roll, idler, -1, -1 if over_wrap else 1)
        span, phi = convex_span(line, theta)
        assert np.angle(span.idler - span.roll) == pytest.approx(
            np.angle(idler[j] - roll[i]), abs=1e-8
        )
        assert np.angle(roll[i]) == pytest.approx(phi, abs=2e-4)


def test_slope_in_polar_form_matches_the_outline() -> None:
    phi, step = 0.8, 1e-6
    (low, high), _ = cubic_radius(np.array([phi - step, phi + step]))
    chord = high * np.exp(1j * (phi + step)) - low * np.exp(1j * (phi - step))
    r, slope = cubic_radius(np.array([phi]))
    assert tangent_slope(float(r[0]), float(slope[0]), phi) == pytest.approx(
        chord.imag / chord.real, rel=1e-8
    )
