"""One look at the bodies of a span against the exact common tangent, solved on its own."""

import numpy as np
import pytest

from sim_plant.effects.shape_rows import add_shape
from sim_plant.geometry.shapes import orders
from sim_plant.geometry.tangent import Body, common_tangent
from sim_plant.line.equations import derivative
from tests.sim_plant.line.lines import declared, exact_line

SPAN = 4
ROWS = {SPAN: ((3, 1e-4, 0.4), (8, 1e-5, 1.0)), SPAN + 1: ((2, 2e-4, 0.0), (5, 2e-5, 2.0))}
"""Orders of both bodies: number, m, rad."""
FIRST_M, SECOND_M, THIRD_M = (
    max(sum(n**k * a for n, a, _ in r) for r in ROWS.values()) for k in (1, 2, 3)
)
"""The largest |h'|, |h''| and |h'''| of either."""
TABLE_M = 1e-13
"""What a table of a shape leaves in h."""


@pytest.fixture
def line():
    return exact_line(declared("euclid"), settle_s=0.0)


def bodies_of(line):
    """Both bodies with their shapes: for the exact tangent, and in the line's arrays."""
    arrays, exact = line.arrays, []
    for k, rows in ROWS.items():
        record = arrays.bodies[k]
        shape = orders(float(record["radius_m"]), rows)
        arrays = add_shape(arrays, k, shape)
        exact.append(
            Body(
                center_x_m=float(record["centre_x_m"]),
                center_y_m=float(record["centre_y_m"]),
                rotation=int(record["sigma"]),
                shape=shape,
            )
        )
    by_name = {name: getattr(arrays, name).view(np.recarray) for name in ("bodies", "web")}
    return arrays._replace(**by_name), exact


def found(line, arrays, start_rad):
    """What the kernel's equation writes for the span from a direction to start at."""
    phi, out = line.state.phi_rad.copy(), np.zeros_like(line.work.contacts)
    phi[SPAN] = start_rad
    derivative.span_contacts.py_func(arrays, line.layout, line.state.y, SPAN, phi, out, more=False)
    return phi[SPAN], out[SPAN]


@pytest.mark.parametrize("share", [0.01, -0.3, 0.9, -0.9, 20.0, -200.0])
def test_a_span_is_the_exact_tangent_from_wherever_its_newton_step_begins(line, share):
    """Below ``NEAR_RAD`` by one look, above by more; the rest is Taylor's of the last step."""
    arrays, (a, b) = bodies_of(line)
    lay, y = line.layout, line.state.y
    step = min(abs(share), 1.0) * derivative.NEAR_RAD
    for theta in np.linspace(0.0, 6.0, 13):
        y[lay.theta + SPAN : lay.theta + SPAN + 2] = theta, 1.7 - theta
        y[lay.omega + SPAN : lay.omega + SPAN + 2] = 20.0, 21.0
        exact = common_tangent(a, b, theta, 1.7 - theta, 20.0, 21.0)
        start = float(exact.phi_rad) + share * derivative.NEAR_RAD
        phi, (length, p_a, p_b, flow, phidot, *_) = found(line, arrays, start)
        radii = a.shape.mean_radius_m + b.shape.mean_radius_m
        turn_rad = 0.6 * radii / length * step**2 + 1e-13  # Newton's rest: F'' / (2 F') step^2
        arm_m = 0.5 * SECOND_M * step**2 + FIRST_M * turn_rad + TABLE_M
        assert abs(phi - exact.phi_rad) <= turn_rad
        assert abs(p_a - exact.arm_a_m) <= arm_m
        assert abs(p_b - exact.arm_b_m) <= arm_m
        assert abs(length - exact.length_m) <= length * step**2 + radii * turn_rad + 1e-11
        assert abs(phidot - exact.phi_rate_rad_s) <= 42.0 * THIRD_M * step**2 / length + 1e-9
        assert abs(flow - exact.flow_a_m_s) <= 22.0 * 2.0 * THIRD_M * step + 1e-8


def test_the_bound_above_tells_a_step_that_is_not_carried():
    """Where the slope of a shape is large its arm would be wrong by h' step."""
    step = 0.9 * derivative.NEAR_RAD
    assert FIRST_M * step > 1e3 * (SECOND_M * step**2 + TABLE_M)
