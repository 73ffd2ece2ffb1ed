"""Refine on a line with a dancer, an oven and an accumulator: an idler off centre is found."""

from __future__ import annotations

import pytest

from sim_plant.line.declared.declaration import Declaration
from tests.sim_plant.effects.running import effect
from tests.sim_plant.effects.tracing import traced
from tests.sim_plant.line.lines import declared

LINE = declared("coater")
AMONG = ("eccentric_roller", "unbalanced_roller", "bearing_drag")
TOLERANCES = {
    "dancers.*": 0.05,
    "accumulators.*": 0.05,
    "heated_spans.*": 0.1,
    "web.thermal_expansion_1_K": 0.1,
    "*": 0.0,
}


def only(kind: str) -> Declaration:
    """Return that line with one kind of body alone; rollers that no carriage has stand."""
    left: dict[str, object] = {}
    for section in ("dancers", "accumulators", "heated_spans"):
        if section != kind:
            left[section] = ()
    gone = {"dancers": "dancer_position_m", "accumulators": "accumulator_position_m"}
    names = {channel for section, channel in gone.items() if section != kind}
    left["sensors"] = tuple(s for s in LINE.sensors if s.channel not in names)
    if kind != "dancers":
        left["control"] = LINE.control.model_copy(update={"position_pi": ()})
    return LINE.model_copy(update=left)


@pytest.mark.long
@pytest.mark.timeout(900)
@pytest.mark.parametrize(
    ("kind", "roller"),
    [
        ("dancers", "R2"),
        ("dancers", "D1"),
        ("accumulators", "A2"),
        ("accumulators", "A3"),
        ("heated_spans", "R4"),
    ],
)
def test_an_idler_off_centre_is_found_beside_bodies_known_to_a_tolerance(
    kind: str, roller: str
) -> None:
    hidden = effect("eccentric_roller", roller, eccentricity_m=2e-4, angle_rad=0.7)
    found = traced(hidden, AMONG, only(kind), TOLERANCES)
    assert [(place.effect, place.location) for place in found.places] == [
        ("eccentric_roller", roller)
    ]
    numbers = found.numbers[0]
    size = float(numbers["cos_m"]) ** 2 + float(numbers["sin_m"]) ** 2
    assert size**0.5 == pytest.approx(2e-4, rel=0.05)
