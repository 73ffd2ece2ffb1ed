"""A saved shape after a new probe: the shape is kept, what was learned of the old P is not."""

from __future__ import annotations

import cmath
import json
import math

import pytest

from aff_runtime.app.control.shape_keeper import ShapeKeeper
from aff_runtime.app.wiring.shape_file import ShapeFile, response_hash, shape_basis_hash
from aff_runtime.core.shape.profile import ShapeProfile
from tests.aff_runtime.app.test_assembled_shape import (
    CYCLE_S,
    EUCLID,
    RECORD,
    REFERENCE_N,
    RESPONSES,
    SHUT,
    SPEED_M_S,
    Line,
)

RADIUS_M = 0.2
OMEGA_RAD_S = SPEED_M_S / RADIUS_M
ROLL_M = {1: 9e-4 - 3e-4j, 2: 2e-4 + 5e-4j, 3: 3e-4 + 1e-4j, 4: -1e-4 + 2e-4j}
LATE_S = 0.1  # the old response was later than the line is by so much
LISTEN_S = 10.0
OWN = response_hash(RESPONSES["unwind"])


def saved(response: str) -> ShapeFile:
    """Return this roll's shape with what was learned over a late response: e^{j w LATE_S} - 1."""
    late = {n: cmath.exp(1j * n * OMEGA_RAD_S * LATE_S) - 1.0 for n in ROLL_M}
    return ShapeFile(
        actuator="unwind",
        belongs_to=shape_basis_hash(EUCLID, "unwind"),
        response=response,
        config_hash="c",
        saved_at="yesterday",
        version="v",
        roll_id=1,
        radius_m={"unwind": RADIUS_M},
        web={},
        profile=ShapeProfile(
            weight_m={("unwind", n): w for n, w in ROLL_M.items()},
            response_ratio_less_1={("unwind", n): d for n, d in late.items()},
            imbalance_m={},
        ),
    )


def frame_rad(line: Line) -> float:
    """Return by how much the law's angle of the roll is ahead of the roll's own."""
    travel_m = SPEED_M_S * line.tick * CYCLE_S
    return math.remainder(
        line.law.phases.by_name["unwind"].theta_rad - travel_m / RADIUS_M, math.tau
    )


def listened(
    text: str,
    *,
    seconds: float = LISTEN_S,
    restart_s: float = math.inf,
    said_s: list[float] | None = None,
) -> tuple[list[str], Line]:
    """Return what a service says of a saved shape while the roll turns that it belongs to.

    After ``restart_s`` nothing is read for 1 s, and the counter of the roll begins at zero then.
    ``said_s`` is given the time of each text.
    """
    said: list[str] = []
    line = Line()
    record = RECORD.starting_from({"unwind": text})
    keeper = ShapeKeeper(record, tell=lambda _, text: said.append(text), keep=lambda *_: None)
    keeper.follow(record)  # an edit in between: nothing is said twice
    law = line.shape
    for tick in range(round(seconds / CYCLE_S)):
        since_s = tick * CYCLE_S - restart_s
        fresh = not 0.0 <= since_s < 1.0
        known = math.isfinite(line.law.phases.by_name["unwind"].origin_rad)
        origin = frame_rad(line)
        seen = law.seen()
        # the ripple of deviation -W_n through P, one tick on
        ripple_N = sum(
            -(ROLL_M[n] * seen[i] * cmath.exp(1j * n * (OMEGA_RAD_S * CYCLE_S - origin))).real
            for i, (roll, n) in enumerate(law.keys)
            if roll == "unwind" and n in ROLL_M and known
        )
        given = {"unwind_tension_N": REFERENCE_N + ripple_N}
        if since_s >= 1.0:
            given["unwind_angle_rad"] = OMEGA_RAD_S * (since_s - 1.0)
        line.step(SHUT, fresh=fresh, **given)
        keeper.feed_trials(line.law, line.values(**given), fresh=fresh, quiet=True)
        if said_s is not None:
            said_s += [tick * CYCLE_S] * (len(said) - len(said_s))
    return said, line


def off_deg(line: Line) -> float:
    """Return by how much the worst of the roll's orders starts at a wrong angle."""
    origin = frame_rad(line)
    start = line.shape.weights()
    right = {n: w * cmath.exp(-1j * n * origin) for n, w in ROLL_M.items()}
    return max(abs(math.degrees(cmath.phase(start["unwind", n] / w))) for n, w in right.items())


def without_response(file: ShapeFile) -> str:
    """Return a file as it was written before it named its response."""
    data = json.loads(file.to_json())
    del data["response"]
    return json.dumps(data)


@pytest.mark.parametrize(
    ("text", "whose"),
    [
        (saved("0123456789abcdef").to_json(), "of another response"),
        (without_response(saved("")), "of a response that it does not name"),
    ],
)
def test_the_delay_of_an_old_response_is_not_taken_for_a_moved_encoder(text, whose):
    said, line = listened(text)
    assert sum(f"its correction of P is {whose}" in t for t in said) == 1, said
    assert not any("turned by" in t for t in said), said
    assert any("starts from the shape saved yesterday" in t for t in said), said
    assert off_deg(line) < 5.0
    assert abs(line.shape.filter.response_ratio_less_1).max() == 0.0


def test_a_correction_of_the_same_response_counts():
    """Here it is wrong, so that it shows: the trial takes it for an encoder that has moved."""
    said, line = listened(saved(OWN).to_json())
    assert not any("correction of P" in t for t in said), said
    assert any("turned by" in t for t in said), said
    assert off_deg(line) > 20.0


def test_the_hash_is_of_what_was_measured_and_not_of_how_it_is_written():
    text = RESPONSES["unwind"]
    again = json.dumps({**json.loads(text), "provenance": {"actuator": "a", "signal": "b"}})
    assert response_hash(again) == OWN
    later = json.dumps({**json.loads(text), "delay_s": 0.041})
    assert response_hash(later) != OWN
    assert response_hash(None) == ""
