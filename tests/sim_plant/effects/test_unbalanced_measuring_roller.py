import numpy as np
import pytest

from sim_plant.base.order_tracking import order_amplitudes
from tests.sim_plant.effects.running import effect, run


@pytest.mark.parametrize("speed_m_s", [0.5, 1.0])
def test_the_reading_shakes_with_speed_squared_and_the_web_does_not(speed_m_s: float) -> None:
    shaken = run(
        effect("unbalanced_measuring_roller", "R3", cos_kg_m=6e-4, sin_kg_m=8e-4),
        seconds=6.0,
        speed_m_s=speed_m_s,
    )
    still = run(seconds=6.0, speed_m_s=speed_m_s)
    assert np.array_equal(shaken["span_tension_N"], still["span_tension_N"])
    extra = shaken["r3_tension_N"] - still["r3_tension_N"]
    omega = speed_m_s / 0.0381
    angle = omega * 0.005 * np.arange(extra.size)
    filtered = 1.0 / abs(1.0 + 1j * omega / (2.0 * np.pi * 20.0))
    assert abs(order_amplitudes(extra, angle, [1])[0]) == pytest.approx(
        1e-3 * omega**2 * filtered, rel=0.02
    )


def test_polar_and_cartesian_words_say_the_same() -> None:
    polar = run(effect("unbalanced_measuring_roller", "R3", unbalance_kg_m=1e-3, angle_rad=0.7))
    parts = run(
        effect(
            "unbalanced_measuring_roller",
            "R3",
            cos_kg_m=1e-3 * np.cos(0.7),
            sin_kg_m=1e-3 * np.sin(0.7),
        )
    )
    assert polar["r3_tension_N"] == pytest.approx(parts["r3_tension_N"], abs=1e-9)
    assert np.std(polar["r3_tension_N"] - run()["r3_tension_N"]) > 0.1
