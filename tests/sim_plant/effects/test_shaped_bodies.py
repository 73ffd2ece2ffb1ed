"""Effects as they reach the arrays: arms, angles, signs of gravity."""

import math

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.effects import eccentric_roller, out_of_round_roll, unbalanced_roller
from sim_plant.effects.out_of_round_roll import KINDS, named
from sim_plant.effects.shape_rows import add_gravity_moment
from sim_plant.elements.contact import body_at
from sim_plant.geometry.roll_profiles import flat_spot
from sim_plant.line.arrays.build import build_arrays, timing_of
from tests.sim_plant.line.lines import declared

LINE = declared("euclid")
FOLLOWER = 11


@pytest.fixture
def arrays():
    return build_arrays(LINE, timing_of(LINE, LINE.sample_time_s))


def put(effect, arrays, place, **parameters):
    return effect.apply(arrays, place, {**effect.EFFECT.parameters, **parameters})


def arm(arrays, place, theta_rad, phi_rad):
    body = arrays.bodies[place]
    p, _dh, _rho = body_at(
        body["radius_m"],
        body["sigma"],
        body["shape_row"],
        arrays.shape_h_m,
        arrays.shape_dh_m,
        arrays.shape_rho_m,
        theta_rad,
        phi_rad,
    )
    return p


@pytest.mark.parametrize("sigma", [1.0, -1.0])
@pytest.mark.parametrize("phi_deg", [0.0, 100.0, 260.0])
def test_eccentric_arm_is_the_distance_from_axis_to_tangent(arrays, sigma, phi_deg):
    """A circle whose centre stands at sigma (theta + angle), touched by a line along phi.

    The web leaves on the side that moves along phi: the contact normal is phi - sigma 90 deg.
    """
    arrays.bodies["sigma"][FOLLOWER] = sigma
    shaped = put(eccentric_roller, arrays, FOLLOWER, eccentricity_m=5e-4, angle_rad=0.3)
    radius, phi = float(arrays.bodies["radius_m"][FOLLOWER]), math.radians(phi_deg)
    for theta in np.linspace(0.0, 7.0, 9):
        centre = 5e-4 * np.exp(1j * sigma * (theta + 0.3))
        normal = np.exp(1j * (phi - sigma * 0.5 * math.pi))
        expected = radius + (centre * normal.conjugate()).real
        assert arm(shaped, FOLLOWER, theta, phi) == pytest.approx(expected, abs=1e-12)


def test_eccentric_mass_makes_the_gravity_torque_of_its_offset(arrays):
    shaped = put(
        eccentric_roller, arrays, FOLLOWER, eccentricity_m=5e-4, angle_rad=0.3, mass_kg=20.0
    )
    assert shaped.bodies["gravity_moment_N_m"][FOLLOWER] == pytest.approx(20.0 * 9.80665 * 5e-4)
    assert shaped.bodies["gravity_moment_angle_rad"][FOLLOWER] == pytest.approx(0.3)


def test_unbalance_is_gravity_alone(arrays):
    heavy = put(unbalanced_roller, arrays, 6, unbalance_kg_m=0.01, angle_rad=-2.0)
    assert heavy.bodies["gravity_moment_N_m"][6] == pytest.approx(0.0980665)
    assert heavy.bodies["gravity_moment_angle_rad"][6] == pytest.approx(-2.0)
    assert heavy.bodies["shape_row"][6] == -1


def test_opposite_imbalances_cancel(arrays):
    add_gravity_moment(arrays, 6, 0.1, 0.5)
    add_gravity_moment(arrays, 6, 0.1, 0.5 + math.pi)
    assert arrays.bodies["gravity_moment_N_m"][6] == pytest.approx(0.0, abs=1e-16)


@pytest.mark.parametrize("angle_rad", [0.0, 0.7])
def test_a_flat_spot_lacks_web_so_the_roll_is_heavy_opposite(arrays, angle_rad):
    """First moment of the outline as a polygon; rounded corners take 5 % off a bare segment."""
    depth, web = 0.012, LINE.web
    radius = float(arrays.bodies["radius_m"][0])
    shaped = put(out_of_round_roll, arrays, 0, size_m=depth, angle_rad=angle_rad)
    z = flat_spot(depth, radius).boundary(np.linspace(0.0, 2.0 * math.pi, 40001)[:-1])
    after = np.roll(z, -1)
    moment_m3 = abs(np.sum((z + after) * (z.conj() * after).imag)) / 6.0
    segment_m3 = 2.0 / 3.0 * (radius * math.sin(math.acos(1.0 - depth / radius))) ** 3
    expected = web.density_kg_m3 * web.width_m * moment_m3 * 9.80665
    assert shaped.bodies["gravity_moment_N_m"][0] == pytest.approx(expected, rel=1e-4)
    assert moment_m3 == pytest.approx(segment_m3, rel=0.07)
    turned = (shaped.bodies["gravity_moment_angle_rad"][0] - angle_rad - math.pi) % (2.0 * math.pi)
    assert min(turned, 2.0 * math.pi - turned) < 1e-6


def test_gravity_can_be_left_out_and_belongs_to_rolls_only(arrays):
    off = put(out_of_round_roll, arrays, 0, size_m=0.012, gravity=0.0)
    assert off.bodies["gravity_moment_N_m"][0] == 0.0
    idler = put(out_of_round_roll, off, 3, size_m=1e-4)
    assert idler.bodies["gravity_moment_N_m"][3] == 0.0
    assert idler.bodies["shape_row"][3] == 1


def test_a_flat_spot_shortens_the_arm_where_it_is(arrays):
    shaped = put(out_of_round_roll, arrays, 0, size_m=0.004)
    arms = [arm(shaped, 0, theta, 0.0) for theta in np.linspace(0.0, 2.0 * math.pi, 720)]
    sigma = shaped.bodies["sigma"][0]
    # body angle of the normal: sigma phi - pi/2 - theta = 0
    lowest = np.linspace(0.0, 2.0 * math.pi, 720)[int(np.argmin(arms))]
    assert sigma in {-1.0, 1.0}
    assert lowest == pytest.approx(1.5 * math.pi, abs=0.02)
    # the web turns round the cut roll's own mean radius; its drive still believes the round one
    true_mean_m = flat_spot(0.004, float(shaped.bodies["radius_m"][0])).mean_radius_m
    assert np.mean(arms[:-1]) == pytest.approx(true_mean_m, abs=1e-9)


@pytest.mark.parametrize("kind", [k for k in KINDS if k != "orders"])
def test_every_named_shape_is_absent_at_size_0_and_turns_by_its_own_mean_radius(arrays, kind):
    absent = put(out_of_round_roll, arrays, 0, shape=kind, angle_rad=0.3)
    assert absent.bodies["shape_row"][0] == -1
    shaped = put(out_of_round_roll, absent, 0, shape=kind, size_m=2e-3, angle_rad=0.3)
    radius = float(shaped.bodies["radius_m"][0])
    assert np.ptp(shaped.shape_h_m[0]) > 2e-4
    own_m = named(kind, 2e-3, radius, 0.3).mean_radius_m - radius
    assert np.mean(shaped.shape_h_m[0, :-1]) == pytest.approx(own_m, abs=1e-9)
    # convex to within the shift between round part and mean radius: a taut web touches it all
    assert np.min(shaped.shape_rho_m[0]) > -radius - 2e-4


def test_orders_are_cosine_and_sine_of_the_body_angle(arrays):
    shaped = put(
        out_of_round_roll,
        arrays,
        0,
        shape="orders",
        cos1_m=1e-4,
        sin2_m=2e-4,
        cos3_m=3e-5,
        sin3_m=-1e-5,
    )
    radius = float(shaped.bodies["radius_m"][0])
    sigma = float(shaped.bodies["sigma"][0])
    for theta in np.linspace(0.0, 6.0, 25):
        psi = sigma * 0.4 - 0.5 * math.pi - theta
        expected = radius + 1e-4 * math.cos(psi) + 2e-4 * math.sin(2 * psi)
        expected += 3e-5 * math.cos(3 * psi) - 1e-5 * math.sin(3 * psi)
        assert arm(shaped, 0, theta, 0.4) == pytest.approx(expected, abs=1e-11)


def test_an_unknown_shape_is_refused(arrays):
    with pytest.raises(PlantError, match="read 'square'; expected one of"):
        put(out_of_round_roll, arrays, 0, shape="square", size_m=1e-3)
