"""What an effect leaves is told beside what its runner-up leaves, in the tension that tells."""

from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.beside_rival import beside_rival
from sim_plant.refine.report.verdict import ChannelRms
from tests.each_case import each_case
from tests.sim_plant.refine.small import finding

ERRORS = {
    "a_tension_N": ChannelRms(before=9.0, after=2.0, noise_floor=1.0),
    "b_tension_N": ChannelRms(before=9.0, after=0.25, noise_floor=0.125),
    "line_speed_m_s": ChannelRms(before=9.0, after=0.01, noise_floor=0.001),
    "unheard_N": ChannelRms(before=9.0, after=1.0, noise_floor=0.0),
}


def drag(rms, runner_up="R5"):
    also = EffectAt("bearing_drag", runner_up) if runner_up else None
    return finding("bearing_drag", "R4", {}, runner_up=also, runner_up_rms=rms)


def test_the_tension_that_differs_most_by_its_noise_is_told():
    """0.5 N more are half a floor of the one, 0.25 N are two of the other."""
    rms = {"a_tension_N": 2.5, "b_tension_N": 0.5, "line_speed_m_s": 9.0, "unheard_N": 9.0}
    assert beside_rival(drag(rms), ERRORS) == (
        "On the record judged the error in b_tension_N is 0.25 N rms with bearing drag at R4, "
        "0.5 N with bearing drag at R5 in its place."
    )


@each_case(
    ("rms", "runner_up"),
    [
        ({}, "R5"),
        ({"line_speed_m_s": 9.0}, "R5"),
        ({"unheard_N": 9.0}, "R5"),
        ({"elsewhere_N": 9.0}, "R5"),
        ({"a_tension_N": 2.5}, ""),
    ],
)
def test_nothing_is_told_where_no_tension_was_judged_with_a_runner_up(rms, runner_up):
    assert beside_rival(drag(rms, runner_up), ERRORS) == ""
