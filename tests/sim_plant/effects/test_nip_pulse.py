import math

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.experiments import experiment
from tests.sim_plant.effects.running import effect, euclid, run
from tests.sim_plant.effects.tracing import traced

RADIUS_M = euclid().rollers[euclid().body("pull_roll")].radius_m
NIP = {"nip_radius_m": 0.04, "lever_m": 2e-3}


def test_the_drive_is_braked_by_lever_times_one_plus_ratio_times_force() -> None:
    """M = b (1 + R / r) f against the motor, at R / r per turn."""
    pulse = run(effect("nip_pulse", "pull_roll", cos_N=60.0, sin_N=-25.0, **NIP))
    ratio = RADIUS_M / 0.04
    torque = {"cos_N_m": -2e-3 * (1.0 + ratio) * 60.0, "sin_N_m": 2e-3 * (1.0 + ratio) * 25.0}
    same = run(effect("torque_ripple", "pull_roll", order=ratio, **torque))
    assert pulse["pull_roll_speed_m_s"] == pytest.approx(same["pull_roll_speed_m_s"], abs=1e-12)
    assert np.std(pulse["pull_roll_speed_m_s"] - run()["pull_roll_speed_m_s"]) > 1e-6


def test_force_and_angle_are_the_two_components_and_a_larger_force_pulses_more() -> None:
    polar = run(effect("nip_pulse", "pull_roll", amplitude_N=65.0, angle_rad=0.5, **NIP))
    force = 65.0 * np.exp(0.5j)
    parts = run(effect("nip_pulse", "pull_roll", cos_N=force.real, sin_N=force.imag, **NIP))
    twice = run(effect("nip_pulse", "pull_roll", amplitude_N=130.0, angle_rad=0.5, **NIP))
    speeds = [made["pull_roll_speed_m_s"] for made in (polar, parts, twice)]
    assert speeds[1] == pytest.approx(speeds[0], abs=1e-12)
    assert np.ptp(speeds[0]) > 1e-6  # without an effect all of them are 0
    assert np.ptp(speeds[2]) == pytest.approx(2.0 * np.ptp(speeds[0]), rel=0.01)


@pytest.mark.parametrize(
    ("place", "radius_m", "said"),
    [("rewind", 0.04, "name a driven roller"), ("pull_roll", 0.0, "expected more than 0")],
)
def test_a_nip_on_a_roll_that_grows_and_one_without_a_radius_are_refused(
    place: str, radius_m: float, said: str
) -> None:
    with pytest.raises(PlantError, match=said):
        run(effect("nip_pulse", place, cos_N=10.0, nip_radius_m=radius_m))


@pytest.mark.parametrize(
    "among", [("nip_pulse", "torque_ripple"), pytest.param((), marks=pytest.mark.long)]
)
def test_refine_finds_it_at_its_roller_with_the_radius_of_the_nip(among: tuple[str, ...]) -> None:
    """Ground 0.06 mm too large, so no radius that is tried is its own."""
    hidden = {"nip_radius_m": 0.04003, "amplitude_N": 20.0, "angle_rad": 0.7}
    found = traced(effect("nip_pulse", "pull_roll", **hidden), among, settle_s=4.0)
    assert found.places == (EffectAt("nip_pulse", "pull_roll"),)
    assert (found.ambiguous, found.unknown) == (((),), ())
    (numbers,) = found.numbers
    assert math.hypot(numbers["cos_N"], numbers["sin_N"]) == pytest.approx(20.0, rel=0.05)
    assert math.atan2(numbers["sin_N"], numbers["cos_N"]) == pytest.approx(0.7, abs=0.05)
    assert numbers["nip_radius_m"] == pytest.approx(0.04003, rel=2e-4)


@pytest.mark.long
def test_a_whole_ratio_is_a_ripple_of_that_order_until_the_nip_is_opened() -> None:
    nip = effect("nip_pulse", "pull_roll", nip_radius_m=RADIUS_M / 2.0, cos_N=20.0)
    ripple = EffectAt("torque_ripple", "pull_roll")
    alike = ("nip_pulse", "torque_ripple", "unbalanced_roller", "eccentric_roller")
    assert traced(nip, alike).places == (ripple,)
    said = experiment(EffectAt("nip_pulse", "pull_roll"), ripple)
    assert said.startswith("open the nip of pull_roll")
