import pytest

from tests.sim_plant.effects.running import SPEED_M_S, at_rest, draw_ratio, effect, euclid


@pytest.mark.parametrize(("ratio", "time_s"), [(0.3, 0.5), (0.3, 5.0)])
def test_strains_behind_the_tensions_obey_the_draw(ratio: float, time_s: float) -> None:
    """Walk down the line: branch strain relaxes over each span's dwell, is stepped at rollers."""
    channels = at_rest(effect("viscoelastic_web", "web", ratio=ratio, time_s=time_s))
    tensions = channels["span_tension_N"].mean(axis=0)
    EA_N, strains = euclid().web.EA_N, []
    strain = euclid().web.wound_in_tension_N / EA_N
    branch = 0.0
    for span, tension in zip(euclid().spans, tensions, strict=True):
        kept = 1.0 / (1.0 + span.length_m / (SPEED_M_S * time_s))
        # tension = EA (strain' + ratio branch'), branch' = kept (branch + strain' - strain)
        after = (tension / EA_N - ratio * kept * (branch - strain)) / (1.0 + ratio * kept)
        branch = kept * (branch + after - strain)
        strain = after
        strains.append(strain)
    draw = (1.0 + strains[15]) / (1.0 + strains[10])
    assert draw == pytest.approx(draw_ratio(channels), abs=6e-6)


def test_a_branch_held_at_one_strain_relaxes_with_its_time() -> None:
    from sim_plant.elements.span import maxwell_rate

    assert maxwell_rate(0.01, 0.0, 0.0, 0.0, 2.0, 0.0) == -0.005
    assert maxwell_rate(0.0, 0.0, 0.0, 0.03, 2.0, 0.0) == 0.03
