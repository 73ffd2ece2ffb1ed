from tests.sim_plant.effects.running import at_rest, effect, mean_tension_N, nominal


def test_drag_makes_the_tension_step_of_its_torque_over_the_radius() -> None:
    dragged = at_rest(effect("bearing_drag", "R6", constant_N_m=0.05, viscous_N_m_s=0.0002))

    def step(channels):  # type: ignore[no-untyped-def]
        return mean_tension_N(channels, "R6-R7") - mean_tension_N(channels, "R5-R6")

    omega = 1.016 / 0.0381
    expected_N = (0.05 + 0.0002 * omega) / 0.0381
    assert abs(step(dragged) - step(nominal()) - expected_N) < 2e-3 * expected_N
