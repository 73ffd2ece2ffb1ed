import pytest

from tests.sim_plant.effects.running import effect, line


@pytest.mark.parametrize(("compliance", "play"), [(1e-3, 0.0), (1e-3, 0.004)])
def test_a_shaft_twists_by_its_torque_and_its_play(compliance: float, play: float) -> None:
    made = line(
        effect(
            "shaft_compliance_backlash", "unwind", compliance_rad_N_m=compliance, backlash_rad=play
        )
    )
    torque_N_m = float(made.state.torque_N_m[0])
    twist = float(made.state.y[made.layout.twist])
    assert torque_N_m < -5.0  # the unwind brakes
    assert twist == pytest.approx(torque_N_m * compliance - 0.5 * play, rel=1e-3)


def test_a_pure_play_gets_the_stiffest_shaft_the_step_resolves() -> None:
    made = line(effect("shaft_compliance_backlash", "pull_roll", backlash_rad=0.002), settle_s=1.0)
    drive = made.arrays.drives[3]
    reduced = 0.25 * 0.05
    assert drive["shaft_stiffness_N_m"] == pytest.approx(reduced * 500.0**2)
    assert drive["shaft_backlash_rad"] == 0.002
