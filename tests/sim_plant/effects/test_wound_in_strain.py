import pytest

from tests.sim_plant.effects.running import at_rest, effect, euclid, mean_tension_N, nominal


def test_a_tighter_roll_turns_faster_by_its_strain() -> None:
    changed = at_rest(effect("wound_in_strain", "unwind", strain=0.001))

    def stretch(channels):  # type: ignore[no-untyped-def]
        surface = channels["unwind_speed_rad_s"] * channels["true_unwind_radius_m"]
        line = channels["true_line_speed_m_s"].mean()
        at_lead = 1.0 + mean_tension_N(channels, "R9-swrap_lead") / euclid().web.EA_N
        return surface.mean() / line * at_lead

    wound_in = euclid().web.wound_in_tension_N / euclid().web.EA_N
    assert stretch(nominal()) - 1.0 == pytest.approx(wound_in, abs=1e-5)
    assert stretch(changed) - stretch(nominal()) == pytest.approx(0.001, rel=1e-2)
