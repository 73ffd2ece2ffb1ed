"""What goes in comes out: unstretched web length, to 1e-9 m, over a speed ramp."""

import math

import numpy as np
import pytest

from tests.sim_plant.line.lines import declared, exact_line


def span_geometry(line):
    """Length and direction of every span at the present radii, closed form for circles."""
    bodies, y = line.arrays.bodies, line.state.y
    radius = bodies["radius_m"].copy()
    radius[0], radius[-1] = y[line.layout.radius : line.layout.radius + 2]
    dx, dy = np.diff(bodies["centre_x_m"]), np.diff(bodies["centre_y_m"])
    reach = np.diff(bodies["sigma"] * radius)
    length = np.sqrt(dx**2 + dy**2 - reach**2)
    return length, np.arctan2(dy, dx) - np.arcsin(reach / np.hypot(dx, dy))


@pytest.mark.parametrize("frozen", [True, False])
def test_unstretched_length_is_conserved_over_a_speed_ramp(frozen):
    """Web out of the unwind = web into the rewind + growth of what the spans hold.

    As the rolls change radius, the two outer spans turn and their contact points wander on the
    first and the last idler; the web that this winds on them is counted at the strain it has.
    """
    line = exact_line(declared("euclid"), frozen=frozen)
    lay, bodies, y = line.layout, line.arrays.bodies, line.state.y
    first, last = bodies[1], bodies[-2]

    def strains():
        return y[lay.strain : lay.strain + lay.n - 1].copy()

    length, phi = span_geometry(line)
    strain, wrapped = strains(), 0.0
    start = np.sum(length / (1.0 + strain))
    drift, held = [], []
    for k in range(600):
        line.step({"line_speed_ref_m_s": 1.016 + 0.508 * min(1.0, k / 400)})
        length, turned = span_geometry(line)
        now = strains()
        mean = 1.0 + 0.5 * (now + strain)
        wrapped -= first["radius_m"] * first["sigma"] * (turned[0] - phi[0]) / mean[0]
        wrapped += last["radius_m"] * last["sigma"] * (turned[-1] - phi[-1]) / mean[-2]
        phi, strain = turned, now
        held.append(np.sum(length / (1.0 + strain)) + wrapped - start)
        drift.append(held[-1] - (y[lay.flow] - y[lay.flow + 1]))
    assert y[lay.flow] > 3.0
    assert max(map(abs, held)) > 1e-6  # the ramp does change what the spans hold
    assert max(map(abs, drift)) < 1e-9


def test_radius_falls_with_the_length_that_left_the_roll():
    """pi (R0^2 - R^2) = thickness * length [source 2.5], with length = integral of R omega."""
    line = exact_line(declared("euclid"), frozen=False)
    lay, y = line.layout, line.state.y
    before = y[lay.radius]
    for _ in range(400):
        line.step({})
    area = math.pi * (before**2 - y[lay.radius] ** 2)
    length = y[lay.flow] * (1.0 + line.arrays.web["supply_strain"][0])
    # the contact point wanders along the roll as the span turns: 1e-4 of the length
    assert area / line.arrays.web["thickness_m"][0] == pytest.approx(length, rel=1e-4)
