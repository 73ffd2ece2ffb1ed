import math

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.effects.out_of_round_roll import (
    EFFECT,
    nearest_profiles,
    profile,
    profile_orders,
    profile_starts,
)
from tests.each_case import each_case
from tests.sim_plant.effects.running import effect, euclid, run

OVAL = {**EFFECT.parameters, "shape": "ellipse", "size_m": 0.002}


def test_a_cut_roll_turns_faster_by_the_web_it_lost() -> None:
    """A chord of depth d takes R (a - sin a) / pi off the mean radius, cos a = 1 - d / R."""
    depth_m, radius_m = 0.012, euclid().initial_radii_m.unwind
    half = np.arccos(1.0 - depth_m / radius_m)
    lost_m = radius_m * (half - np.sin(half)) / np.pi
    cut = run(effect("out_of_round_roll", "unwind", shape="flat", size_m=depth_m), seconds=12.0)
    round_ = run(seconds=12.0)
    turns = cut["unwind_angle_rad"][-1] / (2.0 * np.pi)
    whole = np.interp(2.0 * np.pi * int(turns), cut["unwind_angle_rad"], np.arange(2400.0))
    ratio = (
        2.0 * np.pi * int(turns) / np.interp(whole, np.arange(2400.0), round_["unwind_angle_rad"])
    )
    assert ratio - 1.0 == pytest.approx(lost_m / (radius_m - lost_m), rel=0.03)


def test_orders_add_to_the_named_profile() -> None:
    values = {**OVAL, "cos2_m": 3e-4, "sin3_m": -2e-4}
    psi = np.linspace(0.0, 6.0, 50)
    both = profile(0.2, values).evaluate(psi)[0]
    flat = profile(0.2, OVAL).evaluate(psi)[0]
    low = 3e-4 * np.cos(2.0 * psi) - 2e-4 * np.sin(3.0 * psi)
    assert both - flat == pytest.approx(low, abs=1e-12)


def test_a_profile_is_made_once_of_the_same_numbers() -> None:
    oval = profile(0.2, OVAL)
    assert profile(0.2, dict(OVAL)) is oval
    assert profile(0.21, OVAL).mean_radius_m == pytest.approx(oval.mean_radius_m + 0.01, rel=1e-5)
    assert profile(0.2, {**OVAL, "size_m": 0.004}).deviation_m[1] == pytest.approx(
        2.0 * oval.deviation_m[1], rel=0.01
    )


def test_a_profile_formed_at_another_radius_keeps_its_deviations() -> None:
    formed = profile(0.15, {**EFFECT.parameters, "size_m": 0.01, "formed_radius_m": 0.2})
    fresh = profile(0.2, {**EFFECT.parameters, "size_m": 0.01})
    assert formed.deviation_m == pytest.approx(fresh.deviation_m)
    assert 0.15 - formed.mean_radius_m == pytest.approx(0.2 - fresh.mean_radius_m)


def test_a_profile_is_formed_on_the_roll_as_large_as_it_was_then() -> None:
    told = profile(0.15, {**EFFECT.parameters, "size_m": 0.01, "unwound_m": 0.05})
    named = profile(0.15, {**EFFECT.parameters, "size_m": 0.01, "formed_radius_m": 0.2})
    assert told.deviation_m == pytest.approx(named.deviation_m)
    assert told.mean_radius_m == pytest.approx(named.mean_radius_m)


def test_a_profile_ends_at_its_finest_order() -> None:
    coarse = profile(0.2, {**EFFECT.parameters, "size_m": 0.012, "finest_order": 64.0})
    full = profile(0.2, {**EFFECT.parameters, "size_m": 0.012})
    assert coarse.deviation_m.size == 64
    assert coarse.deviation_m == pytest.approx(full.deviation_m[:64])
    assert coarse.mean_radius_m == full.mean_radius_m
    assert not coarse.is_convex  # it ripples beside its corners


def test_an_ellipse_is_fitted_without_rounding_which_would_only_make_it_smaller() -> None:
    """Its orders are 2, and 4 of d^2 / R; a Gaussian of std s takes exp(-2 s^2) of order 2."""
    rounded = profile(
        0.2, {**OVAL, "size_m": 0.002 * math.exp(2.0 * 0.3**2), "smoothing_rad": 0.3}
    )
    assert rounded.deviation_m == pytest.approx(profile(0.2, OVAL).deviation_m, abs=1.5e-5)
    gain = np.diag([1.0, 1.0, 100.0, 100.0, 1.0, 1.0])  # a record that shows order 2 alone
    against = np.array([0.0, 0.0, 100.0, 0.0, 0.0, 0.0])
    starts = {
        dict(p.choice)["shape"]: p.names
        for p in profile_starts(0.2, gain, against, (1e-3,) * 6, keep=5)
    }
    assert starts["ellipse"] == ("size_m", "angle_rad")
    assert "smoothing_rad" in starts["flat"]


@pytest.mark.parametrize("flanks", [(45.0, 15.0), (15.0, 45.0), (30.0, 30.0)])
def test_a_bump_of_any_flanks_is_looked_for_at_its_own_place(flanks) -> None:
    """The columns are orthogonal: what explains most is the profile next to the true one."""
    rise, fall = (math.radians(w) for w in flanks)
    bump = {**EFFECT.parameters, "shape": "asym", "size_m": 0.004, "angle_rad": 1.0}
    true = profile(0.2, {**bump, "rise_rad": rise, "fall_rad": fall}).deviation_m[:6]
    against = np.stack([true.real, -true.imag], axis=1).ravel() / 1e-3
    best = profile_starts(0.2, np.eye(12), against, (1e-3,) * 12)[0]
    found = dict(zip(best.names, best.start, strict=True))
    assert dict(best.choice)["shape"] == "asym"
    assert (found["rise_rad"], found["fall_rad"]) == pytest.approx((rise, fall))
    assert found["size_m"] == 0.004
    assert found["angle_rad"] == pytest.approx(1.0, abs=0.018)


@pytest.mark.parametrize("width", [2.5, 11.0])
def test_a_bulge_pressed_flat_is_looked_for_at_its_own_width(width) -> None:
    flat = {**EFFECT.parameters, "shape": "flattened_bulge", "size_m": 0.004, "angle_rad": 1.0}
    true = profile(0.2, {**flat, "flat_width_m": width * 0.004}).deviation_m[:6]
    against = np.stack([true.real, -true.imag], axis=1).ravel() / 1e-3
    best = profile_starts(0.2, np.eye(12), against, (1e-3,) * 12)[0]
    found = dict(zip(best.names, best.start, strict=True))
    assert dict(best.choice)["shape"] == "flattened_bulge"
    assert (found["size_m"], found["flat_width_m"]) == pytest.approx((0.004, width * 0.004))


def test_of_every_name_the_profile_most_like_an_outline_is_given_the_best_first() -> None:
    flat = {"shape": "flattened_bulge", "size_m": 0.004, "flat_width_m": 0.026}
    near = nearest_profiles(0.2, profile_orders(0.2, flat, 12))
    assert dict(near[0].choice)["shape"] == "flattened_bulge"
    assert len({dict(one.choice)["shape"] for one in near}) == len(near) > 2


def test_flanks_of_their_own_width_are_those_of_the_plain_profile() -> None:
    plain = profile(0.2, {**EFFECT.parameters, "shape": "asym", "size_m": 0.006})
    flanks = {"rise_rad": math.radians(45.0), "fall_rad": math.radians(30.0)}
    told = profile(0.2, {**EFFECT.parameters, "shape": "asym", "size_m": 0.006, **flanks})
    bulge = profile(0.2, {**EFFECT.parameters, "shape": "bulge", "size_m": 0.006})
    alike = profile(
        0.2,
        {
            **EFFECT.parameters,
            "shape": "asym",
            "size_m": 0.006,
            "rise_rad": math.radians(30.0),
            "fall_rad": math.radians(30.0),
        },
    )
    assert told.deviation_m == pytest.approx(plain.deviation_m)
    assert alike.deviation_m == pytest.approx(bulge.deviation_m)


def test_an_unknown_shape_is_refused_by_its_name() -> None:
    with pytest.raises(PlantError, match="read 'oval'"):
        run(effect("out_of_round_roll", "unwind", shape="oval", size_m=0.001))


def test_a_round_roll_named_flat_is_the_nominal_line() -> None:
    same = run(effect("out_of_round_roll", "unwind", shape="flat", size_m=0.0))
    assert np.array_equal(same["span_tension_N"], run()["span_tension_N"])


@each_case(
    ("given", "said"),
    [
        ({"finest_order": 0}, "finest_order: read 0; expected a whole number, 1 to 256"),
        ({"finest_order": -3}, "finest_order: read -3"),
        ({"finest_order": 1e9}, "finest_order: read 1e.09"),
        ({"finest_order": 1.5}, "finest_order: read 1.5"),
        ({"finest_order": math.nan}, "finest_order: read nan; expected a number"),
        ({"finest_order": None}, "finest_order: read None; expected a number"),
        ({"finest_order": [8]}, r"finest_order: read \[8\]; expected a number"),
        ({"finest_order": 10**400}, "finest_order: read 10000.*; expected a number"),
        ({"unwound_m": -0.3}, "unwound_m: read -0.3; a roll of .* formed at -0.0968 m"),
        ({"unwound_m": 100.0}, "unwound_m: read 100; .* expected more than 0 and at most 5 m"),
        ({"formed_radius_m": -1.0}, "formed_radius_m: read -1"),
        ({"formed_radius_m": 0.2, "unwound_m": 0.01}, "say the same thing; give one of them"),
        ({"smoothing_rad": -0.1}, "smoothing_rad: read -0.1; expected >= 0"),
        ({"size_m": -0.01, "shape": "bulge"}, "size_m: read -0.01; expected >= 0"),
        ({"mean_m": -1.0}, "mean_m: read -1; it leaves nothing"),
    ],
)
def test_numbers_that_no_roll_has_are_refused_by_their_name(given, said) -> None:
    with pytest.raises(PlantError, match=said):
        run(effect("out_of_round_roll", "unwind", **({"shape": "flat", "size_m": 0.005} | given)))
