"""A saved shape after a new probe: what was learned of the old response is not put on it.

On a line of its own it is quick: ``tests/aff_runtime/app/control/test_shape_response.py``.
"""

from __future__ import annotations

import cmath
import json
import math

import pytest

from aff_runtime.app.wiring.shape_file import response_hash
from tests.lockstep.known_response import SPEED_M_S
from tests.lockstep.test_shape_law import learned, ripple, started

__all__ = ["learned"]
pytestmark = [pytest.mark.long, pytest.mark.timeout(300)]
LATE_S = 0.1  # by so much the old response was later than the line is


def over_a_late_response(text: str, named: str | None) -> str:
    """Return a shape file as learned over a response that was late.

    There P over the assumed one is e^{j w LATE_S}; ``named`` is the hash of that response, None
    for a file of before it was kept.
    """
    data = json.loads(text)
    for row in data["orders"]:
        w_rad_s = row["order"] * SPEED_M_S / data["radius_m"][row["roll"]]
        gain = complex(1.0 + row["loop_re"], row["loop_im"]) * cmath.exp(1j * w_rad_s * LATE_S)
        row["loop_re"], row["loop_im"] = gain.real - 1.0, gain.imag
    del data["response"]
    return json.dumps(data if named is None else {**data, "response": named})


def angles_deg(made) -> list[float]:
    """Return the angles of the unwind's first four orders."""
    weights = made.bench.law.shape_laws()["unwind"].weights()
    return [math.degrees(cmath.phase(weights["unwind", n])) for n in range(1, 5)]


def test_what_was_learned_names_its_response(responses, learned):
    *_, kept = learned
    named = json.loads(kept["unwind"])["response"]
    assert named == response_hash(responses["unwind"].to_json())
    assert len(named) == 16


@pytest.mark.parametrize("named", ["0123456789abcdef", None])
@pytest.mark.sweep(every=2)
def test_after_a_new_probe_the_shape_stays_and_the_old_delay_is_no_moved_encoder(
    responses, learned, named
):
    (_, _, before_N), _, kept = learned
    made = started(responses, {"unwind": over_a_late_response(kept["unwind"], named)})
    assert any("correction of P is of" in text for text in made.said), made.said
    assert any("unwind: starts from the shape saved" in text for text in made.said), made.said
    assert not any("turned by" in text for text in made.said), made.said
    assert ripple(made.rows)[2] <= 0.12 * before_N
    straight = angles_deg(started(responses, {"unwind": kept["unwind"]}))
    off = [math.remainder(a - b, 360.0) for a, b in zip(angles_deg(made), straight, strict=True)]
    assert max(map(abs, off)) < 10.0, off
