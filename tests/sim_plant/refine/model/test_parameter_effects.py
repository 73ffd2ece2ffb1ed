import pytest

from sim_plant.effects.catalogue import BY_NAME
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.model.nuisances import declared_nuisances
from sim_plant.refine.model.parameter_effects import as_effects, within_tolerance
from tests.each_case import each_case
from tests.sim_plant.line.lines import declared

LINE = declared("euclid").model_copy(
    update={
        "tolerances": {
            "rollers.*.radius_m": 1e-4,
            "web.EA_N": 0.02,
            "web.wound_in_tension_N": 0.01,
            "rollers.R6.friction_constant_N_m": 0.05,
            "sensors.*.gain": 0.001,
            "sensors.*.offset": 0.1,
        }
    }
)
DRAG_N_M = LINE.rollers[LINE.body("R6")].friction_constant_N_m
STRAIN = LINE.web.wound_in_tension_N / LINE.web.EA_N


@pytest.mark.parametrize(
    ("effect", "place", "names", "within", "beyond"),
    [
        ("radius_error", "swrap_follower", ("ratio",), (1.0 - 0.9e-4,), (1.0 - 1.1e-4,)),
        ("web_modulus", "web", ("factor",), (1.019,), (0.85,)),
        ("wound_in_strain", "unwind", ("strain",), (0.009 * STRAIN,), (-0.011 * STRAIN,)),
        ("bearing_drag", "R6", ("constant_N_m",), (0.049 * DRAG_N_M,), (0.051 * DRAG_N_M,)),
        ("load_cell_calibration", "R9", ("gain", "offset_N"), (1.0009, 0.09), (1.0009, 0.11)),
        ("load_cell_calibration", "R9", ("gain", "offset_N"), (0.9991, 0.0), (0.9989, 0.0)),
    ],
)
def test_a_change_is_an_effect_only_beyond_the_declared_tolerance(
    effect, place, names, within, beyond
):
    h = hypothesis(BY_NAME[effect], place, (), names, LINE)
    nuisances = declared_nuisances(LINE)
    assert within_tolerance(LINE, nuisances, h, within)
    assert not within_tolerance(LINE, nuisances, h, beyond)
    assert not within_tolerance(LINE, [], h, within)  # a number without tolerance is exact


@pytest.mark.parametrize("effect", ["eccentric_roller", "torque_ripple"])
def test_an_effect_that_is_no_declared_number_counts_however_small(effect):
    h = hypothesis(BY_NAME[effect], "swrap_follower", line=LINE)
    assert not within_tolerance(LINE, declared_nuisances(LINE), h, [1e-12] * len(h.names))


@each_case(
    ("number", "shift", "effect", "place", "expected"),
    [
        ("web.EA_N", -0.1, "web_modulus", "web", {"factor": 0.9}),
        ("web.wound_in_tension_N", 0.1, "wound_in_strain", "unwind", {"strain": 0.1 * STRAIN}),
        (
            "rollers.R6.friction_constant_N_m",
            0.5,
            "bearing_drag",
            "R6",
            {"constant_N_m": 0.5 * DRAG_N_M},
        ),
        (
            "sensors.unwind_tension_N.offset",
            1.5,
            "load_cell_calibration",
            "R9",
            {"gain": 1.0, "offset_N": 1.5},
        ),
    ],
)
def test_a_shifted_number_is_said_as_the_effect_that_changes_it(
    number, shift, effect, place, expected
):
    found = {h.key: (h, values) for h, values in as_effects(LINE, number, shift)}
    h, values = found[EffectAt(effect, place)]
    assert dict(zip(h.names, values, strict=True)) == pytest.approx(expected, rel=1e-12)


def test_a_roll_that_turns_faster_is_said_as_a_radius_believed_wrong_or_as_strain_wound_in():
    keys = {h.key for h, _ in as_effects(LINE, "rollers.unwind.effective_radius", -0.005)}
    assert keys == {EffectAt("radius_error", "unwind"), EffectAt("wound_in_strain", "unwind")}


@pytest.mark.parametrize(
    ("number", "shift"),
    [
        ("rollers.R6.friction_constant_N_m", -0.5),  # no bearing drives its roller
        ("rollers.swrap_follower.radius_m", 0.01),  # what seems a radius is mostly a shape
        ("web.density_kg_m3", 0.5),
    ],
)
def test_a_shift_that_no_effect_can_be_is_none(number, shift):
    assert not as_effects(LINE, number, shift)
