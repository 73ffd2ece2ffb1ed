import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.line.rest.operating_point import friction_of, steady_line
from tests.sim_plant.line.lines import declared, exact_line


@pytest.mark.parametrize("speed_m_s", [0.3, 1.016, 1.524])
def test_simulated_line_rests_where_the_balances_put_it(speed_m_s):
    rest = steady_line(declared("euclid"), speed_m_s, 88.9644)
    line = exact_line(declared("euclid"), speed_m_s=speed_m_s)
    lay, y = line.layout, line.state.y
    assert y[lay.strain : lay.strain + lay.n - 1] == pytest.approx(rest.strain, rel=1e-6)
    omega = y[lay.omega : lay.omega + lay.n]
    assert omega * rest.radius_m == pytest.approx(rest.speed_m_s, rel=1e-9)


def test_drag_raises_tension_downstream_by_friction_over_radius():
    """T_down - T_up = friction / R [source 2.34 to 2.41]: nine idlers up to the S-wrap."""
    line = declared("euclid")
    rest = steady_line(line, 1.016, 88.9644)
    torque, _slope = friction_of(line, rest.speed_m_s / rest.radius_m)
    steps = line.web.EA_N * np.diff(rest.strain)[:9]
    assert steps == pytest.approx((torque / rest.radius_m)[1:10], rel=1e-9)
    assert np.all(steps > 0.0)


def test_friction_slope_is_the_derivative_of_friction():
    line = declared("euclid")
    omega = np.linspace(0.05, 3.0, len(line.rollers))
    up, _ = friction_of(line, omega + 1e-6)
    down, _ = friction_of(line, omega - 1e-6)
    assert friction_of(line, omega)[1] == pytest.approx((up - down) / 2e-6, rel=1e-6)


def test_at_standstill_tension_is_even():
    rest = steady_line(declared("euclid"), 0.0, 88.9644)
    assert rest.strain * declared("euclid").web.EA_N == pytest.approx(88.9644)


def test_two_loops_on_one_load_cell_have_no_single_steady_state():
    line = declared("euclid")
    loops = tuple(loop.model_copy(update={"load_cell": "R9"}) for loop in line.control.tension_pi)
    control = line.control.model_copy(update={"tension_pi": loops})
    with pytest.raises(PlantError, match="steady state"):
        steady_line(line.model_copy(update={"control": control}), 1.016, 88.9644)
