import numpy as np
import pytest

from sim_plant.line.equations.rolls import roll_inertia
from sim_plant.line.open import make_line
from sim_plant.line.rest.fastest_mode import fastest_mode
from sim_plant.line.running.simulation import LineSimulation
from tests.sim_plant.effects.running import effect, line
from tests.sim_plant.line.lines import declared, with_effect, with_rolls


def soft(name: str, radius_m: float, **parameters: float) -> LineSimulation:
    """Return a shipped line whose unwind, of this radius at the start, has a soft shaft."""
    there = with_rolls(declared(name), radius_m)
    return make_line(
        with_effect(there, "shaft_compliance_backlash", "unwind", **parameters), seed=None
    )


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


def test_an_encoder_on_the_motor_counts_what_its_speed_adds_up_to() -> None:
    soft_N_m = 90.0
    made = line(effect("shaft_compliance_backlash", "unwind", compliance_rad_N_m=1.0 / soft_N_m))
    samples, step_s = 400, made.sample_time_s
    tension_N = np.where(np.arange(samples) < 50, 80.0, 110.0)
    found = made.simulate(np.full(samples, 1.0), tension_N)
    speed, angle = found["unwind_speed_rad_s"], found["unwind_angle_rad"]
    turned = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * step_s)))
    np.testing.assert_allclose(angle, turned, atol=1e-3)
    lag_rad = found["true_unwind_angle_rad"] - angle
    pull_N = found["true_unwind_tension_N"][-1] - found["true_unwind_tension_N"][0]
    radius_m = found["unwind_radius_m"][-1]
    assert lag_rad[-1] == pytest.approx(pull_N * radius_m / soft_N_m, rel=0.05)


@pytest.mark.parametrize(
    ("roller", "drive", "core_kg_m2"), [("pull_roll", 3, 0.05), ("unwind", 0, 0.25)]
)
def test_a_pure_play_gets_the_stiffest_shaft_the_step_resolves(
    roller: str, drive: int, core_kg_m2: float
) -> None:
    made = line(effect("shaft_compliance_backlash", roller, backlash_rad=0.002), settle_s=1.0)
    found = made.arrays.drives[drive]
    reduced = 0.25 * core_kg_m2
    assert found["shaft_stiffness_N_m"] == pytest.approx(reduced * 500.0**2)
    assert found["shaft_backlash_rad"] == 0.002


@pytest.mark.parametrize("name", ["film", "coater"])
def test_wound_web_is_on_the_other_side_of_the_shaft_than_the_motor(name: str) -> None:
    core_kg_m2 = declared(name).inertia_kg_m2.unwind_core_and_drive
    for radius_m in (0.3, 0.2):
        made = soft(name, radius_m, compliance_rad_N_m=1.5e-3, motor_share=0.3)
        motor = made.arrays.drives["motor_share"][0] * made.arrays.bodies["inertia_kg_m2"][0]
        assert motor == pytest.approx(0.3 * core_kg_m2, rel=1e-12)


def unwound(made: LineSimulation, radius_m: float) -> None:
    """Let the unwind of a running line have this radius: the same rim, the same pull at it."""
    lay, state = made.layout, made.state
    share = radius_m / state.y[lay.radius]
    fixed = float(made.arrays.bodies["inertia_kg_m2"][0])
    before, after = (roll_inertia(made.arrays, fixed, r) for r in (state.y[lay.radius], radius_m))
    state.y[lay.omega] /= share
    state.y[lay.motor] /= share
    state.y[lay.twist] *= share
    state.drive_integral[0] *= share * before / after
    state.y[lay.radius] = radius_m


@pytest.mark.parametrize(("name", "share"), [("film", 0.5), ("coater", 0.5), ("coater", 0.9)])
def test_a_soft_shaft_holds_the_tension_down_to_the_core(name: str, share: float) -> None:
    shape = {"compliance_rad_N_m": 1.5e-3, "motor_share": share}
    made = soft(name, declared(name).initial_radii_m.unwind, **shape)
    made.settle(4.0)
    full_m, core_m = made.state.y[made.layout.radius], declared(name).initial_radii_m.core
    at = declared(name).operating_point
    rows = np.full(600, at.line_speed_m_s), np.full(600, at.tension_N)
    made.arrays.web["thickness_m"] = 0.0  # each radius stays while it is looked at
    made.simulate(*rows)
    for radius_m in (0.8 * full_m, 0.7 * full_m, 1.02 * core_m):
        unwound(made, radius_m)
        held_N = made.simulate(*rows)["span_tension_N"][-200:, 0]
        # motor and body swing against each other for seconds after the start
        assert np.all(np.abs(held_N - at.tension_N) < 0.2 * at.tension_N), radius_m


def test_the_steps_follow_the_shaft_of_an_empty_core() -> None:
    """sqrt(K (1/motor + 1/rest)) of 0.25 kg m2 without web: two halves on a spring of 1e4 N m."""
    made = soft("euclid", 0.2, compliance_rad_N_m=1e-4, damping=0.0)
    mode = fastest_mode(declared("euclid"), made.arrays, made.lengths_m)
    assert mode.where == "the shaft of unwind"
    assert mode.rate_rad_s == pytest.approx(np.sqrt(1e4 * 2.0 / 0.125), rel=1e-9)
