import numpy as np
import pytest

from sim_plant.geometry.shapes import circle, ellipse
from sim_plant.geometry.source_ellipse import (
    EllipseLine,
    center_tangent_phi_rad,
    cost,
    ellipse_span,
    signed_distance_m,
)
from sim_plant.geometry.tangent import Body, common_tangent


@pytest.mark.parametrize("over_wrap", [True, False])
@pytest.mark.parametrize("upper", [True, False])
@pytest.mark.parametrize(("a_m", "b_m"), [(0.21, 0.19), (0.2, 0.2), (0.12, 0.2), (0.03, 0.05)])
def test_minimised_tangent_agrees_with_the_exact_one(
    a_m: float, b_m: float, upper: bool, over_wrap: bool
) -> None:
    line = EllipseLine(
        a_m=a_m,
        b_m=b_m,
        idler_x_m=0.7,
        idler_y_m=-0.25,
        idler_radius_m=0.0381,
        upper=upper,
        over_wrap=over_wrap,
    )
    sigma = -1 if upper else 1
    a = Body(center_x_m=0.0, center_y_m=0.0, rotation=sigma, shape=ellipse(a_m, b_m))
    b = Body(
        center_x_m=0.7,
        center_y_m=-0.25,
        rotation=sigma if over_wrap else -sigma,
        shape=circle(0.0381),
    )
    deltas = np.linspace(-3.0, 6.5, 24)
    span = common_tangent(a, b, sigma * deltas, 0.0)
    found = [ellipse_span(line, float(delta)) for delta in deltas]
    assert [s.length_m for s in found] == pytest.approx(span.length_m, abs=1e-8)
    assert [np.angle(s.idler - s.roll) for s in found] == pytest.approx(span.phi_rad, abs=1e-8)


LINE = EllipseLine(
    a_m=0.2, b_m=0.3, idler_x_m=1.0, idler_y_m=0.2, idler_radius_m=0.05, upper=True, over_wrap=True
)


def test_phi_0_is_where_the_tangent_meets_the_idler_centre() -> None:
    center = complex(LINE.idler_x_m, LINE.idler_y_m)
    phi_0 = center_tangent_phi_rad(LINE, center)
    assert signed_distance_m(LINE, phi_0, center) == pytest.approx(0.0, abs=1e-15)
    u, v = center.real / LINE.a_m, center.imag / LINE.b_m
    corrected = np.arcsin((v + np.sqrt(u**2 * (u**2 + v**2 - 1.0))) / (u**2 + v**2))
    # arcsine takes the branch below 90 degrees of the corrected (4.9)
    assert min(phi_0, np.pi - phi_0) == pytest.approx(corrected, abs=1e-12)


def test_distance_is_that_of_the_line_and_cost_its_squared_misfit() -> None:
    phi, point = 0.4, 0.9 + 0.3j
    touch = complex(LINE.a_m * np.cos(phi), LINE.b_m * np.sin(phi))
    along = complex(-LINE.a_m * np.sin(phi), LINE.b_m * np.cos(phi))
    wanted = abs(((point - touch) * np.conj(along)).imag) / abs(along)
    assert abs(signed_distance_m(LINE, phi, point)) == pytest.approx(wanted, rel=1e-13)
    assert cost(LINE, phi, point) == pytest.approx((wanted - 0.05) ** 2, rel=1e-12)
