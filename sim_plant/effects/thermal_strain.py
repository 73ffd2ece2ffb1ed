"""Web that is warmer (or moister) in a part of the line."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Parameter, Value


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Give span ``place`` a free strain: T = EA (strain - free), the strain still carries mass.

    Between two speeds that stand, the strain is set by the mass balance [source 2.20], so tension
    falls by EA free; where a loop holds tension, the drive's speed moves instead. The web takes
    and loses its free strain where it enters and leaves the spans named.
    """
    arrays.spans["free_strain"][place] += float(parameters["strain"])
    return arrays


EFFECT = Effect(
    name="thermal_strain",
    place="span",
    candidates="zone",
    accepts={
        "strain": Parameter(
            default=0.0, unit="1", typical=0.0005, low=-0.02, high=0.02, linear=True
        )
    },
    traced=("strain",),
    apply=apply,
    text="the web is warmer in a zone: it is longer without being pulled",
    shows=None,
    remedy="measure the web's temperature before and after {place}",
)
