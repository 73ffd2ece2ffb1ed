"""Web that is warmer (or moister) in a part of the line."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import FREE_STRAIN, IDLER, LineArrays
from sim_plant.base.effects import Effect, Form, Parameter, Value
from sim_plant.effects.onset import FOREVER_S, FROM, HOLD, RISE, begins, begins_later, with_change


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Give span ``place`` a free strain: T = EA (strain - free), the strain still carries mass.

    Between two speeds that stand, the strain is set by the mass balance [source 2.20], so tension
    falls by EA free; where a loop holds tension, the drive's speed moves instead. The web takes
    and loses its free strain where it enters and leaves the spans named.

    Of a zone, web may be warm from a later span on: ``warm_from_span`` spans from its start are
    not, the rest of one in part. With ``from_s`` the strain comes at a moment of the record, over
    ``rise_s``, and goes ``hold_s`` later as it came.
    """
    strain = float(parameters["strain"]) * _warm_share(arrays, place, parameters)
    if begins_later(parameters):
        return with_change(arrays, FREE_STRAIN, place, strain, parameters)
    arrays.spans["free_strain"][place] += strain
    return arrays


def _warm_share(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> float:
    """Return how much of span ``place`` is warm, 0..1; zones begin at a roll or driven roller."""
    first = place
    while arrays.bodies["kind"][first] == IDLER:
        first -= 1
    return min(max(place - first + 1.0 - float(parameters["warm_from_span"]), 0.0), 1.0)


EFFECT = Effect(
    name="thermal_strain",
    place="span",
    candidates="zone",
    accepts={
        "strain": Parameter(
            default=0.0, unit="1", typical=0.0005, low=-0.02, high=0.02, linear=True
        ),
        "warm_from_span": Parameter(
            default=0.0, unit="1", typical=0.0, low=0.0, high=100.0, role="shape", step=0.25
        ),
        "from_s": FROM,
        "rise_s": RISE,
        "hold_s": HOLD,
    },
    fitted=("strain",),
    apply=apply,
    text="the web is warmer or cooler in a zone: it is longer or shorter at the same pull",
    shows=None,
    onset=begins(
        "strain",
        "rise_s",
        "hold_s",
        "warm_from_span",
        grid={
            "warm_from_span": (0.0, 2.0, 4.0, 6.0, 8.0),
            "hold_s": (6.0, 9.0, 12.0, 15.0, FOREVER_S),
            "rise_s": (0.5, 1.0, 2.0),
        },
    ),
    remedy="measure the web's temperature before and after {place}",
    forms=(
        Form(
            strengths=("strain",),
            sign=1,
            text="the web is warmer or moister in a zone: it is longer without being pulled",
        ),
        Form(
            strengths=("strain",),
            sign=-1,
            text="the web is cooler or drier in a zone: it is shorter without being let go",
        ),
    ),
)
