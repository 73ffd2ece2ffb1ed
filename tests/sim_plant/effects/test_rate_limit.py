import pytest

from tests.sim_plant.effects.running import effect, line


def test_a_jump_of_the_correction_becomes_a_ramp_of_the_limit() -> None:
    made = line(effect("rate_limit", "swrap_follower", slew_m_s2=0.04), settle_s=2.0)
    start = float(made.state.reference_m_s[2])
    for samples in range(1, 41):
        made.step({"aff_swrap_follower_m_s": 0.005})
        wanted = start + min(0.04 * 0.005 * samples, 0.005)
        assert made.state.reference_m_s[2] == pytest.approx(wanted, abs=1e-12)
