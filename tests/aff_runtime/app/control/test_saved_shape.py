"""A saved shape is tried by ear before anything goes out: on which roll, from which angle."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import pytest

from aff_runtime.app.wiring.shape_file import ShapeFile
from aff_runtime.core.shape.profile import ShapeProfile
from aff_runtime.core.shape.trial import TURNS
from tests.aff_runtime.app.control.test_shape_response import (
    OMEGA_RAD_S,
    OWN,
    ROLL_M,
    Line,
    listened,
    off_deg,
    saved,
)
from tests.aff_runtime.app.test_assembled_shape import EUCLID

TURNED_RAD = 0.6


def of_weights(weight_m: dict[int, complex]) -> ShapeFile:
    """Return this roll's file with other orders, nothing learned of P."""
    profile = ShapeProfile(
        weight_m={("unwind", n): w for n, w in weight_m.items()},
        response_ratio_less_1={},
        imbalance_m={},
    )
    return replace(saved(OWN), profile=profile)


def is_empty(line: Line) -> bool:
    return all(w == 0j for (roll, _), w in line.shape.weights().items() if roll == "unwind")


def test_the_shape_of_this_roll_is_started_from():
    said, line = listened(of_weights(ROLL_M).to_json())
    assert any("starts from the shape saved yesterday" in t for t in said), said
    assert not any("turned by" in t for t in said), said
    assert off_deg(line) < 5.0


def test_an_encoder_whose_origin_moved_is_found_out_before_anything_goes_out():
    turned = {n: w * cmath.exp(1j * n * TURNED_RAD) for n, w in ROLL_M.items()}
    said, line = listened(of_weights(turned).to_json())
    assert any("turned by" in t for t in said), said
    assert off_deg(line) < 5.0


@pytest.mark.parametrize("into_trial", [0.5, 0.8, 0.9])
@pytest.mark.sweep(every=3)
def test_a_trial_begins_anew_where_the_roll_goes_on_from_another_origin(into_trial):
    memory_s = EUCLID.actuators["unwind"].response_memory_s
    turns_s = TURNS * math.tau / OMEGA_RAD_S
    restart_s = memory_s + into_trial * turns_s
    text = of_weights(ROLL_M).to_json()
    seconds, said_s = restart_s + 1.5 + memory_s + turns_s, []
    said, line = listened(text, seconds=seconds, restart_s=restart_s, said_s=said_s)
    tried_s = [at for at, t in zip(said_s, said, strict=True) if "agreement" in t]
    assert tried_s, said
    assert min(tried_s) > restart_s + 1.0 + turns_s
    assert line.law.phases.by_name["unwind"].origin_losses == 1
    assert any("turned by" in t for t in said), said
    assert off_deg(line) < 5.0


def test_the_shape_of_another_roll_is_not_used():
    said, line = listened(replace(of_weights(ROLL_M), roll_id=7).to_json())
    assert any("it is of roll 7, now there is roll" in t for t in said), said
    assert is_empty(line)


def test_a_shape_that_is_not_the_rolls_is_refused_by_the_ripple():
    other = {1: 1e-4j, 2: 1e-4 + 0j, 3: 9e-4j, 4: 6e-4 + 0j}
    said, line = listened(of_weights(other).to_json())
    assert any("not used: the ripple is another" in t for t in said), said
    assert is_empty(line)
