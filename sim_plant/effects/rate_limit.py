"""A drive that lets its speed reference change only so fast."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Parameter, Value


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Limit the velocity reference of drive ``place`` to ``slew_m_s2``; 0 is no limit.

    |v_k - v_k-1| <= slew tick. Inactive, hence without trace, while nothing asks for more.
    """
    slew = float(parameters["slew_m_s2"])
    if slew != 0.0:
        arrays.drives["slew_m_s2"][place] = slew
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
        )
    },
    traced=("slew_m_s2",),
    apply=apply,
    text="a drive ramps its reference: fast corrections and speed changes come out slower",
    shows=None,
    remedy="let the tension correction enter behind the ramp of drive {place}",
)
