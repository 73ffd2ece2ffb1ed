import pytest

from aff_runtime.base.errors import PlantError
from tests.sim_plant.effects.running import effect, line


def test_a_jump_of_the_correction_becomes_a_ramp_of_the_limit() -> None:
    made = line(effect("rate_limit", "swrap_follower", slew_m_s2=0.04), settle_s=2.0)
    start = float(made.state.reference_m_s[2])
    for samples in range(1, 41):
        made.step({"aff_swrap_follower_m_s": 0.005})
        wanted = start + min(0.04 * 0.005 * samples, 0.005)
        assert made.state.reference_m_s[2] == pytest.approx(wanted, abs=1e-12)


def test_a_limited_correction_lets_the_lines_own_ramp_pass() -> None:
    """The line ramps at 0.2 m/s2, five times the limit; the correction arrives at the limit."""
    limited = effect("rate_limit", "swrap_follower", slew_m_s2=0.04, limits="correction")
    made = line(limited, settle_s=2.0)
    start = float(made.state.reference_m_s[2])
    for samples in range(1, 41):
        speed = 1.016 + 0.2 * 0.005 * samples
        made.step({"aff_swrap_follower_m_s": 0.005, "line_speed_ref_m_s": speed})
        came = min(0.04 * 0.005 * samples, 0.005)
        assert made.state.correction_m_s[2] == pytest.approx(came, abs=1e-12)
        drawn = (speed - 1.016) * start / 1.016
        assert made.state.reference_m_s[2] == pytest.approx(start + drawn + came, abs=1e-3)


def test_a_tension_loop_behind_a_limit_rests_where_it_rests_without_one() -> None:
    """What stands still is not limited: the settled line is the same."""
    free = line(settle_s=20.0)
    limited = effect("rate_limit", "unwind", slew_m_s2=0.2, limits="correction")
    slow = line(limited, settle_s=20.0)
    assert slow.state.loop_correction_m_s == pytest.approx(
        free.state.loop_correction_m_s, abs=1e-7
    )


def test_another_word_is_refused() -> None:
    with pytest.raises(PlantError, match="expected reference or correction"):
        line(effect("rate_limit", "unwind", slew_m_s2=0.1, limits="torque"), settle_s=1.0)
