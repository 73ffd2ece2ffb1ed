import math

import numpy as np
import pytest

from sim_plant.effects.splice import EFFECT
from sim_plant.line.equations.spliced_spans import on_wrap
from tests.each_case import each_case
from tests.sim_plant.effects.running import (
    SPEED_M_S,
    at_rest,
    drawn_tension_N,
    effect,
    euclid,
    line,
    mean_tension_N,
    nominal,
    run,
    span,
)


def path_length_m() -> float:
    """Length of web from the unwind to the rewind, from the declaration's own wrap angles."""
    spans = sum(span.length_m for span in euclid().spans)
    wraps = [(r.wrap_angle_deg or 0.0) * r.radius_m for r in euclid().rollers]
    return spans + math.radians(sum(wraps))


def test_after_the_splice_has_passed_the_line_is_one_of_the_new_web() -> None:
    spliced = at_rest(effect("splice", "web", EA_factor=0.8, at_length_m=2.0), seconds=70.0)
    expected_N = drawn_tension_N(spliced, 0.8 * euclid().web.EA_N)
    assert mean_tension_N(spliced, "R15-pull_roll") == pytest.approx(expected_N, abs=0.03)
    old_N = drawn_tension_N(spliced, euclid().web.EA_N)
    assert abs(expected_N - old_N) > 0.5


def test_unstretched_length_is_kept_while_the_splice_is_under_way() -> None:
    """On spans and on bodies: old web stays on a body until the splice has left it."""
    plant = line(effect("splice", "web", EA_factor=0.5, at_length_m=1.0), settle_s=4.0)
    layout, EA_N = plant.layout, euclid().web.EA_N
    wraps_m = path_length_m() - sum(span.length_m for span in euclid().spans)

    def on_spans_m() -> float:
        strain = plant.state.y[layout.strain : layout.strain + layout.n - 1]
        return float(np.sum(plant.work.contacts[:, 0] / (1.0 + strain)))

    before, start = on_spans_m(), plant.state.y[layout.flow : layout.flow + 2].copy()
    plant.simulate(np.full(3600, SPEED_M_S), np.full(3600, 88.9644))
    flow = plant.state.y[layout.flow : layout.flow + 2] - start
    strain = 88.9644 / EA_N
    on_bodies_m = wraps_m / (1.0 + 2.0 * strain) - wraps_m / (1.0 + strain)
    assert abs(on_bodies_m) > 0.1 * strain * wraps_m
    gained_m = on_spans_m() - before + on_bodies_m
    assert gained_m == pytest.approx(flow[0] - flow[1], abs=0.03 * abs(on_bodies_m))


def test_before_the_splice_leaves_the_roll_nothing_is_different() -> None:
    later = at_rest(effect("splice", "web", EA_factor=0.9, at_length_m=100.0))
    assert np.array_equal(later["span_tension_N"], nominal()["span_tension_N"])


def test_thickness_changes_at_the_unwind_at_once_and_at_the_rewind_one_path_later() -> None:
    made = run(effect("splice", "web", thickness_factor=1.3, at_length_m=3.0), seconds=30.0)
    time_s = np.arange(made["true_unwind_radius_m"].size) * 0.005
    growth = -np.gradient(made["true_unwind_radius_m"], time_s) / made["unwind_speed_rad_s"]
    level = 0.00019 / (2.0 * math.pi)
    start_s = 3.0 / SPEED_M_S
    assert growth[time_s < start_s - 0.1] == pytest.approx(level, rel=5e-3)
    assert growth[time_s > start_s + 0.1] == pytest.approx(1.3 * level, rel=5e-3)
    arrival_s = start_s + path_length_m() / SPEED_M_S
    plant = line(effect("splice", "web", thickness_factor=1.3, at_length_m=3.0))
    radii, step = [], 20
    for _ in range(round(30.0 / (0.005 * step))):
        plant.simulate(np.full(step, SPEED_M_S), np.full(step, 88.9644))
        radii.append(float(plant.state.y[plant.layout.radius + 1]))
    rate = np.diff(radii)
    jump_s = 0.1 * (1 + int(np.argmax(rate > 1.15 * rate[0])))
    assert jump_s == pytest.approx(arrival_s, abs=0.25)


def test_a_seam_lifts_the_web_off_a_roller_while_a_part_of_it_is_on_the_wrap() -> None:
    piece_m, wrap_m = 0.08, 0.3
    past_m = np.arange(-0.1, 0.6, 0.001)
    lifted = np.array([on_wrap(piece_m, float(past), wrap_m) for past in past_m])
    assert np.trapezoid(lifted, past_m) == pytest.approx(wrap_m + piece_m, abs=2e-3)
    assert lifted.max() == 1.0
    assert not lifted[past_m < 0.0].any()
    assert on_wrap(piece_m, 0.1, 0.0) == 0.0


def test_a_seam_on_the_follower_feeds_the_draw_zone_and_one_on_the_pull_roll_empties_it() -> None:
    seam = effect("splice", "web", step_m=3e-4, piece_m=0.08, at_length_m=0.5)
    made, plain = run(seam, seconds=30.0), run(seconds=30.0)
    change = made["span_tension_N"] - plain["span_tension_N"]
    zone = change[:, span("R13-R14")]
    assert zone.min() < -0.5
    assert zone.max() > 0.5
    assert np.argmin(zone) < np.argmax(zone)


def test_a_seam_leaves_nothing_behind_when_it_is_on_the_roll() -> None:
    made = at_rest(effect("splice", "web", step_m=3e-4, at_length_m=0.5), seconds=70.0)
    plain = at_rest(seconds=70.0)
    assert made["span_tension_N"] == pytest.approx(plain["span_tension_N"], abs=0.02)


@each_case(
    ("found", "is_seam"),
    [
        ({"step_m": 5e-4, "piece_m": 0.1}, True),
        ({"EA_factor": 0.8}, False),
        ({"EA_factor": 0.8, "step_m": 5e-4}, False),
        ({}, False),
    ],
)
def test_a_seam_alone_is_told_as_a_seam_and_not_as_another_web(
    found: dict[str, float], is_seam: bool
) -> None:
    text, remedy = EFFECT.words({**found, "at_length_m": 19.0})
    assert ("seam" in text) is is_seam
    assert ("tape" in remedy) is is_seam
    assert ("webs before and after" in remedy) is not is_seam
