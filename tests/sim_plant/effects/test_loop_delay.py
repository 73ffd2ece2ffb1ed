import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from tests.sim_plant.effects.running import effect, run


def test_a_correction_arrives_later_and_otherwise_unchanged() -> None:
    wave = 0.01 * np.sin(2.0 * np.pi * 1.5 * 0.005 * np.arange(800))
    still = run(seconds=4.0)["swrap_follower_speed_m_s"]
    prompt = run(seconds=4.0, aff={"swrap_follower": wave})["swrap_follower_speed_m_s"]
    late = run(
        effect("loop_delay", "swrap_follower", delay_s=0.02),
        seconds=4.0,
        aff={"swrap_follower": wave},
    )["swrap_follower_speed_m_s"]
    moved = prompt - still
    assert np.max(np.abs(moved)) > 3e-3
    assert (late - still)[4:] == pytest.approx(moved[:-4], abs=2e-5)


def test_a_delay_longer_than_its_buffer_is_refused() -> None:
    with pytest.raises(PlantError, match="drive ticks"):
        run(effect("loop_delay", "unwind", delay_s=1.0))
