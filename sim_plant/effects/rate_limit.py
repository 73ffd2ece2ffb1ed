"""A drive, its correction's input, or a tension loop's output that changes only so fast."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Demand, Effect, Parameter, Start, Value

LIMITED = {"reference": "slew_m_s2", "correction": "correction_slew_m_s2"}
"""Column of the drive for each word of ``limits`` that acts in a drive."""
LOOP = "loop"
BELOW_A_RAMP = (0.0003, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3)
"""Shares of a ramp's rate by which a limit may be below it. What comes of it grows in proportion,
so a size is a start for those up to three times larger; above the ramp nothing comes of it."""


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Limit the velocity reference of drive ``place``, or a part of it; 0 is no limit.

    |v_k - v_k-1| <= slew T. Inactive, hence without trace, while nothing asks for more. A
    reference is what a drive's ramp generator takes: line speed and correction as one sum, T is
    the drive tick. A correction is ramped where tension loop and AFF enter, behind that generator;
    the line's own ramps pass. A loop limits what it gives, T is its own sample: it jumps by slew T
    where a ramp in the drive needs T to get there, half a sample ahead on the way; AFF passes.
    """
    slew, limits = float(parameters["slew_m_s2"]), str(parameters["limits"])
    if slew == 0.0:
        return arrays
    if limits == LOOP:
        arrays.loops["slew_m_s2"][arrays.drives["loop"][place]] = slew
    else:
        arrays.drives[LIMITED[limits]][place] = slew
    return arrays


def refuses(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> str:
    """Return why drive ``place`` cannot have it: no loop trims it; "" where it can."""
    if parameters["limits"] == LOOP and int(arrays.drives["loop"][place]) < 0:
        return f"no loop trims this drive; expected limits: {' or '.join(LIMITED)}"
    return ""


def beside(there: Mapping[str, Value], more: Mapping[str, Value]) -> str:
    """Return that two limits of the same part are one too many; those of other parts are two."""
    both = float(there["slew_m_s2"]) != 0.0 and float(more["slew_m_s2"]) != 0.0
    same = both and there["limits"] == more["limits"]
    return f"on the {there['limits']}, and two of it do not add" if same else ""


def starts(arrays: LineArrays, place: int, demand: Demand) -> list[Start]:
    """Return limits of the reference just below the rate of the fastest ramp, which meets them."""
    rate = demand.fastest_ramp_m_s2 * (1.0 + arrays.drives["draw"][place])
    shares = BELOW_A_RAMP if rate > 0.0 else ()
    return [
        Start(
            choice={"slew_m_s2": rate * (1.0 - share), "limits": "reference"},
            acts_below={"slew_m_s2": rate},
        )
        for share in shares
    ]


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
            words=(*LIMITED, LOOP),
            tries=(LOOP, "correction", "reference"),
        ),
    },
    fitted=("slew_m_s2",),
    apply=apply,
    text="a drive ramps its reference or its correction, or a tension loop its output: "
    "fast changes come out slower",
    shows=None,
    remedy="look at the ramp times of drive {place} and of its tension loop; let the tension "
    "correction enter behind them",
    refuses=refuses,
    beside=beside,
    starts=starts,
)
