"""A load cell with a wrong scale or zero."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import DeclaredNumber, Effect, Parameter, Value
from sim_plant.effects.experiments import of_the_cell


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Read gain T + offset at cell ``place``, on top of what it reads already."""
    cell = arrays.cells[place]
    gain = float(parameters["gain"])
    cell["gain"] *= gain
    cell["offset_N"] = gain * float(cell["offset_N"]) + float(parameters["offset_N"])
    return arrays


EFFECT = Effect(
    name="load_cell_calibration",
    place="cell",
    candidates="cell",
    accepts={
        "gain": Parameter(default=1.0, unit="1", typical=1.05, low=0.5, high=2.0, linear=True),
        "offset_N": Parameter(
            default=0.0, unit="N", typical=2.0, low=-200.0, high=200.0, linear=True
        ),
    },
    fitted=("gain", "offset_N"),
    apply=apply,
    text="a load cell reads a wrong scale or zero: the loop holds the reading, not the tension",
    shows=None,
    remedy="calibrate {place} with a known weight",
    experiment=of_the_cell,
    declared_as=(
        DeclaredNumber(number="sensors.{place}.gain", parameter="gain"),
        DeclaredNumber(number="sensors.{place}.offset", parameter="offset_N"),
    ),
    sensor_only=True,
)
