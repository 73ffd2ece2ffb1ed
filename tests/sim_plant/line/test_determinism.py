import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.effects.catalogue import CATALOGUE
from sim_plant.line.open import make_line
from tests.sim_plant.line.lines import declared, with_effect


def run(line, seed, samples=200, **options):
    simulation = make_line(line, seed=seed, **options)
    return simulation.simulate(np.full(samples, 1.016), np.full(samples, 88.9644), {})


def identical(a, b):
    return a.keys() == b.keys() and all(np.array_equal(a[name], b[name]) for name in a)


def test_same_seed_is_bit_identical_and_another_is_not():
    line = declared("euclid_ripple")
    first, again, other = run(line, 3), run(line, 3), run(line, 4)
    assert identical(first, again)
    assert not np.array_equal(first["unwind_tension_N"], other["unwind_tension_N"])


@pytest.mark.parametrize("seed", [None, 7])
def test_stepping_equals_a_whole_run_to_the_bit(seed):
    line = declared("euclid_ripple")
    rng = np.random.default_rng(1)
    tension, correction = 89.0 + rng.normal(size=120), 1e-3 * rng.normal(size=120)
    whole = make_line(line, seed=seed).simulate(
        np.full(120, 1.016), tension, {"unwind": correction}
    )
    stepped = make_line(line, seed=seed)
    for k in range(119):
        row = stepped.step(
            {
                "line_speed_ref_m_s": 1.016,
                "tension_ref_N": tension[k],
                "aff_unwind_m_s": correction[k],
            }
        )
        for channel in stepped.channels:
            assert row[channel.name] == whole[channel.name][k + 1]
            assert row["true_" + channel.name] == whole["true_" + channel.name][k + 1]


def test_a_run_in_two_parts_equals_a_run_in_one():
    line = make_line(declared("euclid_ripple"), seed=5)
    halves = [line.simulate(np.full(100, 1.016), np.full(100, 88.9644), {}) for _ in range(2)]
    whole = run(declared("euclid_ripple"), 5)
    for name in ("unwind_tension_N", "unwind_angle_rad", "span_tension_N"):
        assert np.array_equal(np.concatenate([h[name] for h in halves]), whole[name])


@pytest.mark.parametrize("effect", CATALOGUE, ids=lambda effect: effect.name)
def test_an_effect_at_its_neutral_value_is_exactly_absent(effect):
    location = {
        "body": "unwind",
        "drive": "unwind",
        "cell": "R9",
        "loop": "unwind",
        "span": "R1-R2",
        "web": "web",
        "number": "web.EA_N",
    }[effect.place]
    bare = run(declared("euclid"), 2, samples=100)
    neutral = run(with_effect(declared("euclid"), effect.name, location), 2, samples=100)
    assert identical(bare, neutral)


def test_an_effect_changes_the_run_it_is_put_on():
    bare = run(declared("euclid"), 2, samples=100)
    for effect, size in (
        ("eccentric_roller", {"eccentricity_m": 1e-3}),
        ("out_of_round_roll", {"size_m": 5e-3}),
        ("unbalanced_roller", {"unbalance_kg_m": 0.1}),
    ):
        ill = run(with_effect(declared("euclid"), effect, "unwind", **size), 2, samples=100)
        assert not np.array_equal(bare["span_tension_N"], ill["span_tension_N"])


def test_unknown_inputs_and_undriven_rollers_are_refused():
    line = make_line(declared("euclid"))
    with pytest.raises(PlantError, match="input 'speed' is unknown"):
        line.step({"speed": 1.0})
    with pytest.raises(PlantError, match="'R3' has no drive"):
        line.step({"aff_R3_m_s": 0.0})
