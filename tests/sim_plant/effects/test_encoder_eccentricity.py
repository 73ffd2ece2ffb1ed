import numpy as np
import pytest

from sim_plant.base.order_tracking import order_amplitudes
from tests.sim_plant.effects.running import effect, run


def test_only_the_recorded_channels_wobble() -> None:
    made = run(effect("encoder_eccentricity", "unwind", cos=6e-4, sin=8e-4))
    assert np.array_equal(made["span_tension_N"], run()["span_tension_N"])
    theta = made["true_unwind_angle_rad"]
    wobble = 6e-4 * np.cos(theta) + 8e-4 * np.sin(theta)
    ratio = made["unwind_speed_rad_s"] / made["true_unwind_speed_rad_s"] - 1.0
    assert ratio == pytest.approx(wobble, abs=1e-9)


def test_the_angle_read_is_the_integral_of_the_speed_read() -> None:
    made = run(effect("encoder_eccentricity", "unwind", cos=6e-3, sin=8e-3))
    speed = made["unwind_speed_rad_s"]
    grown = np.cumsum(0.5 * (speed[1:] + speed[:-1])) * 0.005
    assert made["unwind_angle_rad"][1:] == pytest.approx(grown, abs=2e-5)


def test_a_loop_that_reads_it_moves_the_roller_as_the_opposite_reference_would() -> None:
    rows, speed_m_s = 2400, 1.016 * 1.0005
    still = run(seconds=12.0)["true_pull_roll_speed_m_s"]
    made = run(effect("encoder_eccentricity", "pull_roll", cos=1e-3, loop_share=1.0), seconds=12.0)
    moved = made["true_pull_roll_speed_m_s"] - still
    angle = speed_m_s / 0.0762 * 0.005 * np.arange(rows)
    wave = -1e-3 * speed_m_s * np.cos(angle)
    forced = run(seconds=12.0, aff={"pull_roll": wave})["true_pull_roll_speed_m_s"] - still
    by_encoder = abs(order_amplitudes(moved[600:], angle[600:], [1])[0])
    by_reference = abs(order_amplitudes(forced[600:], angle[600:], [1])[0])
    # the reference passes the loop's own zero as the reading does; 5 ms hold costs little
    assert by_encoder == pytest.approx(by_reference, rel=0.03)
    assert by_encoder > 2e-4
