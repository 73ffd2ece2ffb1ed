import math

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.base.order_tracking import order_amplitudes
from tests.sim_plant.effects.running import effect, line, run


def test_the_mandrel_answers_tension_and_unbalance_as_a_damped_mass() -> None:
    """X = (T + u omega^2) / (m (w^2 - omega^2 + 2 j zeta w omega)) at order 1."""
    given = {"mass_kg": 20.0, "frequency_Hz": 2.0, "damping": 0.1, "cos1_kg_m": 0.05}
    made = line(effect("roll_bounce", "unwind", **given))
    theta, travel, pull = [], [], []
    for _ in range(2500):
        made.step({})
        theta.append(made.angles()[0])
        travel.append(made.state.y[made.layout.bounce])
        pull.append(made.work.tensions[0])
    angle = np.array(theta)
    omega = (angle[-1] - angle[0]) / (0.005 * (angle.size - 1))
    X = order_amplitudes(np.array(travel), angle, [1])[0]
    force_N = order_amplitudes(np.array(pull), angle, [1])[0] + 0.05 * omega**2
    w = 2.0 * math.pi * 2.0
    assert force_N / (20.0 * (w**2 - omega**2 + 0.2j * w * omega)) == pytest.approx(X, rel=0.02)


def test_its_other_order_grows_towards_the_resonance() -> None:
    made = run(
        effect("roll_bounce", "unwind", mass_kg=20.0, cosn_kg_m=0.03, order=4.0), seconds=10.0
    )
    found = np.abs(
        order_amplitudes(made["unwind_tension_N"], made["unwind_angle_rad"], [1, 2, 3, 4])
    )
    assert found[3] > 20.0 * np.max(found[:3])


def test_only_the_unwind_can_bounce() -> None:
    with pytest.raises(PlantError, match="only the unwind"):
        run(effect("roll_bounce", "R3", mass_kg=20.0))
