"""Changes that begin at a moment of the record, against constant ones and formulas."""

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.line.equations.changing_numbers import level
from tests.each_case import each_case
from tests.sim_plant.effects.running import effect, euclid, line, run, span

SAMPLE_S = 0.005


def span_N(channels: dict[str, np.ndarray], name: str) -> np.ndarray:
    return channels["span_tension_N"][:, span(name)]


def test_before_the_moment_nothing_is_different() -> None:
    plain = run(seconds=3.0)
    later = run(effect("bearing_drag", "R13", constant_N_m=0.05, from_s=2.0), seconds=3.0)
    before = round(1.99 / SAMPLE_S)
    assert np.array_equal(later["span_tension_N"][:before], plain["span_tension_N"][:before])
    assert not np.allclose(later["span_tension_N"][-1], plain["span_tension_N"][-1])


def test_after_the_moment_drag_is_what_it_is_when_it_was_always_there() -> None:
    """At rest T_down - T_up = torque / R across the idler."""
    made = run(effect("bearing_drag", "R13", constant_N_m=0.05, from_s=2.0), seconds=40.0)
    plain = run(seconds=40.0)
    step_N = span_N(made, "R13-R14") - span_N(made, "R12-R13")
    step_N -= span_N(plain, "R13-R14") - span_N(plain, "R12-R13")
    radius_m = euclid().rollers[euclid().body("R13")].radius_m
    assert step_N[-200:].mean() == pytest.approx(0.05 / radius_m, rel=5e-3)


def test_warmth_that_stays_is_warmth_that_was_always_there() -> None:
    there = run(effect("thermal_strain", "pull_roll_zone", strain=3e-4), seconds=60.0)
    came = run(effect("thermal_strain", "pull_roll_zone", strain=3e-4, from_s=2.0), seconds=60.0)
    assert came["span_tension_N"][-200:] == pytest.approx(there["span_tension_N"][-200:], abs=0.08)
    first = round(1.9 / SAMPLE_S)
    assert span_N(there, "R15-pull_roll")[first] < span_N(came, "R15-pull_roll")[first] - 0.5


def test_warmth_that_ends_leaves_the_line_as_it_was() -> None:
    warm = effect("thermal_strain", "pull_roll_zone", strain=3e-4, from_s=2.0, hold_s=3.0)
    made, plain = run(warm, seconds=40.0), run(seconds=40.0)
    gone = span_N(made, "R15-pull_roll") - span_N(plain, "R15-pull_roll")
    assert gone.min() < -0.5
    assert abs(gone[-200:]).max() < 0.02


@each_case(
    ("time_s", "expected"),
    [(0.9, 0.0), (1.0, 0.0), (1.5, 0.5), (2.0, 1.0), (4.9, 1.0), (5.5, 0.5), (6.0, 0.0)],
)
def test_a_change_rises_holds_and_falls_as_it_rose(time_s: float, expected: float) -> None:
    assert level(time_s, 1.0, 1.0, 5.0) == pytest.approx(expected)


def test_web_that_is_warm_from_a_later_span_on_is_not_warm_before() -> None:
    """3.5 spans of the zone's five are cool: half of the fourth and the last are warm."""
    warm = effect("thermal_strain", "pull_roll_zone", strain=3e-4, warm_from_span=3.5, from_s=1.0)
    strain = dict.fromkeys(range(len(euclid().spans)), 0.0)
    for change in line(warm, settle_s=0.1).arrays.changes:
        strain[int(change["place"])] += float(change["amount"])
    first = span("swrap_follower-R12")
    found = [strain[first + k] for k in range(5)]
    assert found == pytest.approx([0.0, 0.0, 0.0, 1.5e-4, 3e-4])
    assert sum(strain.values()) == pytest.approx(4.5e-4)


def test_a_strain_is_wound_at_the_unwind_only() -> None:
    with pytest.raises(PlantError, match="unwind only"):
        run(effect("wound_in_strain", "R3", strain=1e-3))
