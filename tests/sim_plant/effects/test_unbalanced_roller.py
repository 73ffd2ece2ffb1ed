import numpy as np
import pytest

from tests.sim_plant.effects.running import effect, line


def test_two_unbalances_add_as_phasors() -> None:
    made = line(
        effect("unbalanced_roller", "R6", cos_kg_m=0.003),
        effect("unbalanced_roller", "R6", unbalance_kg_m=0.004, angle_rad=np.pi / 2.0),
        settle_s=1.0,
    )
    body = made.arrays.bodies[6]
    assert body["gravity_moment_N_m"] == pytest.approx(0.005 * 9.80665)
    assert body["gravity_moment_angle_rad"] == pytest.approx(np.arctan2(4.0, 3.0))
