"""Every balance against its formula, a limit or a derivative taken another way."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from sim_plant.elements.contact import body_at, tangent
from sim_plant.elements.drive import speed_pi
from sim_plant.elements.load_cell import expected_quantise, filter_rate, quantise, resonance_rates
from sim_plant.elements.material_roll import radius_rate, wound_inertia
from sim_plant.elements.roller import friction_torque, gravity_torque
from sim_plant.elements.span import strain_rate, tension
from sim_plant.elements.tension_loop import tension_pi


def test_speed_pi_gives_proportional_and_integral_torque():
    """Kp = J K, Ki = Kp K / (4 zeta^2) [source 2.24]: after n ticks of a constant error."""
    integral = 0.0
    for _ in range(50):
        torque, integral = speed_pi(0.4, 15.0, 1.1, 0.2, integral, 1e-3, 120.0)
    corner = 15.0 / (4.0 * 1.1**2)
    assert torque == pytest.approx(0.4 * 15.0 * 0.2 * (1.0 + corner * 0.05))
    assert integral == pytest.approx(0.01)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_speed_pi_stops_integrating_at_the_torque_limit(sign):
    torque, integral = speed_pi(0.4, 15.0, 1.1, sign * 100.0, 0.3, 1e-3, 120.0)
    assert torque == sign * 120.0
    assert integral == 0.3


def test_speed_pi_poles_have_the_declared_damping():
    """s^2 + K s + K w = 0 has damping zeta when w = K / (4 zeta^2)."""
    poles = np.roots([1.0, 15.0, 15.0 * 15.0 / (4.0 * 0.7**2)])
    assert -poles[0].real / abs(poles[0]) == pytest.approx(0.7)
    torque, _ = speed_pi(1.0, 15.0, 0.7, 1.0, 0.0, 1e-9, 1e9)
    assert torque == pytest.approx(15.0)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_tension_pi_is_the_declared_law(sign):
    correction, integral = tension_pi(0.002, 10.0, sign, 3.0, 0.5, 0.01)
    assert integral == pytest.approx(0.53)
    assert correction == pytest.approx(sign * 0.002 * (3.0 + 10.0 * 0.53))


def test_filter_has_its_corner_where_declared():
    s = 2j * math.pi * 20.0
    y = 1.0 / (1.0 + s / (2.0 * math.pi * 20.0))
    assert filter_rate(20.0, 0.0, 1.0) == pytest.approx(-2.0 * math.pi * 20.0)
    assert filter_rate(20.0, 1.0, 0.0) == pytest.approx(2.0 * math.pi * 20.0)
    assert abs(y) == pytest.approx(math.sqrt(0.5))


def test_resonance_rests_at_its_input_and_swings_at_its_frequency():
    assert resonance_rates(40.0, 0.05, 5.0, 5.0, 0.0) == (0.0, 0.0)
    columns = [resonance_rates(40.0, 0.05, 0.0, *unit) for unit in ((1.0, 0.0), (0.0, 1.0))]
    poles = np.linalg.eigvals(np.array(columns).T)
    assert abs(poles[0]) == pytest.approx(2.0 * math.pi * 40.0)
    assert -poles[0].real / abs(poles[0]) == pytest.approx(0.05)


def test_quantise_rounds_to_its_step_and_not_at_all_without():
    assert quantise(0.126, 0.05) == pytest.approx(0.15)
    assert quantise(-0.126, 0.05) == pytest.approx(-0.15)
    assert quantise(0.126, 0.0) == 0.126


@pytest.mark.parametrize("noise_sd", [0.0005, 0.001, 0.004])
def test_expected_quantise_is_the_mean_of_many_noisy_words(noise_sd):
    """Against the exact mean over Gaussian noise: sum of words times their probability."""
    lsb = 0.002
    for value in (3.0001, 3.0004, 3.0009, -3.0017):
        words = lsb * np.arange(round(value / lsb) - 40, round(value / lsb) + 41)
        edge = (words - 0.5 * lsb - value) / (noise_sd * math.sqrt(2.0))
        below = np.array([0.5 * (1.0 + math.erf(e)) for e in edge])
        mean = float(np.sum(words[:-1] * np.diff(below)) / np.sum(np.diff(below)))
        assert expected_quantise(value, lsb, noise_sd) == pytest.approx(mean, abs=1e-6)
    assert expected_quantise(3.0001, 0.0, 0.1) == 3.0001


def test_wound_inertia_is_that_of_a_hollow_cylinder():
    shells, _ = quad(lambda r: 2.0 * math.pi * 1000.0 * 0.15 * r**3, 0.04, 0.2)
    assert wound_inertia(1000.0, 0.15, 0.2, 0.04) == pytest.approx(shells)
    assert wound_inertia(1000.0, 0.15, 0.04, 0.04) == 0.0


def test_radius_changes_by_one_thickness_per_turn():
    turn_s = 2.0 * math.pi / 5.0
    assert radius_rate(1.5e-4, 5.0, -1.0) * turn_s == pytest.approx(-1.5e-4)
    assert radius_rate(1.5e-4, 5.0, 1.0) == -radius_rate(1.5e-4, 5.0, -1.0)


def test_friction_is_odd_and_approaches_coulomb_plus_viscous():
    assert friction_torque(0.15, 0.01, 5.0) == pytest.approx(0.15 + 0.05)
    assert friction_torque(0.15, 0.01, -5.0) == -friction_torque(0.15, 0.01, 5.0)
    assert friction_torque(0.15, 0.01, 0.0) == 0.0


@pytest.mark.parametrize("sigma", [1.0, -1.0])
def test_gravity_torque_is_minus_the_slope_of_potential_energy(sigma):
    """U = m g e sin(gamma), gamma = sigma (theta + angle) from the horizontal."""
    for theta in np.linspace(-4.0, 4.0, 9):
        up = 0.5 * math.sin(sigma * (theta + 1e-6 + 0.4))
        down = 0.5 * math.sin(sigma * (theta - 1e-6 + 0.4))
        slope = (up - down) / 2e-6
        assert gravity_torque(0.5, 0.4, sigma, theta) == pytest.approx(-slope, abs=1e-9)
    assert gravity_torque(0.0, 0.4, sigma, 1.0) == 0.0


def test_strain_grows_by_what_is_pulled_out_beyond_what_comes_in():
    """L deps/dt / (1 + eps) = v_out - v_in - flow (eps - up) / (1 + up)."""
    assert strain_rate(2.0, 0.001, 0.001, 1.0, 1.01, 1.0) == pytest.approx(0.01 * 1.001 / 2.0)
    rate = strain_rate(2.0, 0.002, 0.001, 1.0, 1.0, 1.0)
    assert rate == pytest.approx(-1.002 / 2.0 * 0.001 / 1.001)


def test_strain_rate_conserves_unstretched_length():
    """d(L / (1 + eps))/dt = flow_in / (1 + up) - v_out / (1 + eps) for a span of fixed length."""
    L, eps, up, v_in, v_out = 1.3, 0.0021, 0.0013, 0.97, 1.02
    rate = strain_rate(L, eps, up, v_in, v_out, v_in)
    held = -L * rate / (1.0 + eps) ** 2
    assert held == pytest.approx(v_in / (1.0 + up) - v_out / (1.0 + eps), rel=1e-12)


def test_tension_is_elastic_plus_damping_and_never_pushes():
    assert tension(50000.0, 0.002, 1e-3, 0.1) == pytest.approx(100.0 + 5.0)
    assert tension(50000.0, -0.002, 1e-3, 0.1) == 0.0


def test_tangent_of_two_circles_is_the_closed_form():
    """Crossed belt: sin(angle) = (R_A + R_B) / D, L^2 = D^2 - (R_A + R_B)^2; open alike."""
    for sigma_b, reach in ((1.0, 0.05 - 0.2), (-1.0, -0.05 - 0.2)):
        phi = -math.asin(reach / 0.9)
        residual, length = tangent(0.9, 0.0, 1.0, 0.2, 0.0, sigma_b, 0.05, 0.0, phi)
        assert residual == pytest.approx(0.0, abs=1e-15)
        assert length == pytest.approx(math.sqrt(0.9**2 - reach**2))


def test_a_true_circle_needs_no_table():
    none = np.zeros((1, 9))
    assert body_at(0.2, -1.0, -1, none, none, none, 1.0, 2.0) == (0.2, 0.0, 0.2)


@pytest.mark.parametrize("flow_m_s", [0.8, -0.8])
def test_web_that_passes_a_contact_takes_its_strain_along_either_way(flow_m_s):
    """L deps/(1+eps) = -|ldot| (eps - eps_up)/(1+eps_up): the span nears what passes into it."""
    found = strain_rate(1.5, 0.004, 0.001, 1.0, 1.0, flow_m_s)
    assert found == pytest.approx(1.004 / 1.5 * -0.8 * 0.003 / 1.001)
