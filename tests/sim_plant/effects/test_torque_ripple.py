import numpy as np
import pytest

from sim_plant.base.order_tracking import order_amplitudes
from sim_plant.refine.model.effect_at import EffectAt
from tests.sim_plant.effects.running import effect, run
from tests.sim_plant.effects.tracing import traced

GRAVITY_M_S2 = 9.80665


def test_order_one_is_the_torque_of_an_unbalance() -> None:
    """A counter-clockwise body, heavy at angle 0: -m g e cos(theta)."""
    ripple = run(effect("torque_ripple", "pull_roll", order=1.0, cos_N_m=-0.01 * GRAVITY_M_S2))
    heavy = run(effect("unbalanced_roller", "pull_roll", cos_kg_m=0.01))
    assert ripple["span_tension_N"] == pytest.approx(heavy["span_tension_N"], abs=1e-9)
    assert np.std(ripple["span_tension_N"] - run()["span_tension_N"]) > 0.01


def test_a_mesh_of_a_few_teeth_shows_at_its_count() -> None:
    made = run(effect("torque_ripple", "unwind", order=5.0, sin_N_m=0.5), seconds=12.0)
    found = np.abs(
        order_amplitudes(made["unwind_speed_rad_s"], made["unwind_angle_rad"], [3, 4, 5, 6, 7])
    )
    assert np.argmax(found) == 2
    assert found[2] > 30.0 * np.sort(found)[-2]


@pytest.mark.parametrize("among", [("torque_ripple", "unbalanced_roller"), ()])
@pytest.mark.long  # quick: the same way, test_nip_pulse.py
def test_refine_finds_it_at_its_drive_and_order(among: tuple[str, ...]) -> None:
    hidden = effect("torque_ripple", "pull_roll", order=5.0, cos_N_m=0.3, sin_N_m=-0.4)
    found = traced(hidden, among)
    assert found.places == (EffectAt("torque_ripple", "pull_roll"),)
    assert (found.ambiguous, found.unknown) == (((),), ())
    (numbers,) = found.numbers
    assert numbers == pytest.approx({"order": 5.0, "cos_N_m": 0.3, "sin_N_m": -0.4}, rel=0.05)
