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
    with pytest.raises(PlantError, match="expected reference or correction or loop"):
        line(effect("rate_limit", "unwind", slew_m_s2=0.1, limits="torque"), settle_s=1.0)


def test_a_loop_gives_no_more_than_its_limit_from_one_of_its_samples_to_the_next() -> None:
    """Its law from its own error and integral, limited; between its samples it stands still."""
    made = line(effect("rate_limit", "unwind", slew_m_s2=0.1, limits="loop"), settle_s=4.0)
    law, loop_s = made.arrays.loops[0], 0.01
    limited = 0
    for sample in range(60):
        last, error = made.state.loop_correction_m_s[0], 93.0 - made.state.measured_N[0]
        made.step({"tension_ref_N": 93.0})
        if sample % 2:  # two samples of the record to one of the loop
            assert made.state.loop_correction_m_s[0] == last
            continue
        wanted = law["gain_m_s_N"] * (error + law["corner_rad_s"] * made.state.loop_integral[0])
        change = law["sign"] * wanted - last
        limited += abs(change) > 0.1 * loop_s
        came = min(max(change, -0.1 * loop_s), 0.1 * loop_s)
        assert made.state.loop_correction_m_s[0] == pytest.approx(last + came, abs=1e-12)
    assert 5 < limited < 30


def test_a_limited_loop_is_half_a_sample_ahead_of_a_drive_that_ramps_as_fast() -> None:
    """It jumps by slew T at its sample; the drive takes T to get there."""
    ahead = []
    for limits in ("loop", "correction"):
        made = line(
            effect("rate_limit", "unwind", slew_m_s2=0.02, limits=limits),
            settle_s=4.0,
            sample_time_s=0.001,
        )
        start = made.state.reference_m_s[0]
        made.step({"tension_ref_N": 120.0})
        ahead.append(abs(made.state.reference_m_s[0] - start))
    assert ahead == pytest.approx([0.02 * 0.01, 0.02 * 0.001], rel=1e-6)


def test_what_aff_corrects_passes_a_limited_loop() -> None:
    made = line(effect("rate_limit", "unwind", slew_m_s2=0.02, limits="loop"), settle_s=4.0)
    before = made.state.reference_m_s[0]
    made.step({"aff_unwind_m_s": 0.005})
    assert made.state.reference_m_s[0] - before == pytest.approx(0.005, abs=0.02 * 0.01)


def test_a_drive_that_no_loop_trims_has_none_to_limit() -> None:
    limited = effect("rate_limit", "pull_roll", slew_m_s2=0.1, limits="loop")
    with pytest.raises(PlantError, match=r"effects\.0: rate_limit at pull_roll: no loop trims"):
        line(limited, settle_s=1.0)


def test_what_a_limit_below_a_ramp_leaves_grows_with_its_distance() -> None:
    """The starts of a search rest on it: the lag at the ramp's end is share x rate x its time."""
    lags = []
    for share in (0.001, 0.003, 0.01):
        made = line(effect("rate_limit", "swrap_follower", slew_m_s2=0.2 * (1.0 - share)))
        first = float(made.state.reference_m_s[2])
        for sample in range(1, 401):
            made.step({"line_speed_ref_m_s": 1.016 + 0.2 * 0.005 * sample})
        lags.append(first + 0.2 * 0.005 * 400 - float(made.state.reference_m_s[2]))
    assert lags == pytest.approx([0.2 * 2.0 * share for share in (0.001, 0.003, 0.01)], rel=0.03)
