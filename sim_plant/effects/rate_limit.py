"""A drive, or its correction's input, that changes only so fast."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Parameter, Value

LIMITED = {"reference": "slew_m_s2", "correction": "correction_slew_m_s2"}
"""Column of the drive for each word of ``limits``."""


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Limit the velocity reference of drive ``place``, or its correction alone; 0 is no limit.

    |v_k - v_k-1| <= slew tick. Inactive, hence without trace, while nothing asks for more. A
    reference is what a drive's ramp generator takes: line speed and correction as one sum. A
    correction is ramped where tension loop and AFF enter, behind that generator; the line's own
    ramps pass.
    """
    slew = float(parameters["slew_m_s2"])
    if slew != 0.0:
        arrays.drives[LIMITED[str(parameters["limits"])]][place] = slew
    return arrays


EFFECT = Effect(
    name="rate_limit",
    place="drive",
    candidates="drive",
    accepts={
        "slew_m_s2": Parameter(
            default=0.0,
            unit="m/s2",
            typical=0.1,
            low=0.0,
            high=100.0,
            tries=(0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.5),
        ),
        "limits": Parameter(
            default="reference",
            unit="",
            role="option",
            words=tuple(LIMITED),
            tries=("correction", "reference"),
        ),
    },
    traced=("slew_m_s2",),
    apply=apply,
    text="a drive ramps its reference, or the correction: fast changes come out slower",
    shows=None,
    remedy="look at the ramp times of drive {place}; let the tension correction enter behind them",
)
