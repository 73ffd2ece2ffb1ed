import numpy as np
import pytest

from sim_plant.effects.eccentric_roller import EFFECT
from tests.sim_plant.effects.running import at_rest, effect, nominal


def test_polar_and_cartesian_words_say_the_same() -> None:
    polar = at_rest(effect("eccentric_roller", "R6", eccentricity_m=2e-4, angle_rad=0.7))
    parts = at_rest(
        effect("eccentric_roller", "R6", cos_m=2e-4 * np.cos(0.7), sin_m=2e-4 * np.sin(0.7))
    )
    assert polar["r3_tension_N"] == pytest.approx(parts["r3_tension_N"], abs=1e-7)
    assert np.std(polar["r3_tension_N"] - nominal()["r3_tension_N"]) > 0.1


def test_a_gauge_reads_twice_the_eccentricity_in_total() -> None:
    given = {**EFFECT.parameters, "cos_m": 3e-4, "sin_m": 4e-4}
    assert EFFECT.run_out is not None
    assert EFFECT.run_out(given) == pytest.approx(1e-3)
