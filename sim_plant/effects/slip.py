"""A driven roller on which the web slips once it runs fast enough."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import SLIP, LineArrays
from sim_plant.base.effects import Demand, Effect, Form, Parameter, Start, Value
from sim_plant.effects.beside import where_alike
from sim_plant.effects.onset import FROM, HOLD, begins, begins_later, with_change

SHARES_ABOVE = (1.0, 0.5, 0.25, 0.125)
"""Of the range of a record's speeds, the shares above the threshold that a search begins at. Where
every speed of the range is there as long, what slips above a share b and above a share a of it
have a correlation of sqrt(r) (1.5 - 0.5 r), r = b / a  [own]: 0.88 from one to the next."""


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Let the web follow only the share 1 - slope (v - threshold) of roller ``place``'s speed.

    [own; linear loss above the speed at which the air film carries]. A negative slope is web
    pulled ahead. Both spans at the roller see the web's speed. With ``from_s`` the roller begins
    to slip at a moment of the record, and holds again ``hold_s`` later.
    """
    slope = float(parameters["slope_s_m"])
    if slope == 0.0:
        return arrays
    body = arrays.bodies[place]
    body["slip_speed_m_s"] = float(parameters["threshold_m_s"])
    if begins_later(parameters):
        return with_change(arrays, SLIP, place, slope, parameters)
    body["slip_s_m"] += slope
    return arrays


def starts(_arrays: LineArrays, _place: int, demand: Demand) -> list[Start]:
    """Return thresholds among the speeds that the records have: above them nothing slips."""
    low, high = demand.slowest_m_s, demand.fastest_m_s
    thresholds = [high - share * (high - low) for share in SHARES_ABOVE] if high > low else []
    return [
        Start(choice={"threshold_m_s": threshold}, acts_below={})
        for threshold in thresholds
        if threshold > 0.0
    ]


EFFECT = Effect(
    name="slip",
    place="body",
    candidates="gripping",
    accepts={
        "slope_s_m": Parameter(
            default=0.0, unit="s/m", typical=0.002, low=-0.1, high=0.1, linear=True
        ),
        "threshold_m_s": Parameter(
            default=1.0, unit="m/s", typical=1.0, low=0.0, high=20.0, role="shape", tries=(0.0,)
        ),
        "from_s": FROM,
        "hold_s": HOLD,
    },
    fitted=("slope_s_m", "threshold_m_s"),
    apply=apply,
    text="the web slips on a driven roller above a speed, and runs slower or faster than it",
    shows=None,
    wander=0.02,  # how well a roller holds the web varies: draw wanders by 5 to 20 % at one speed
    onset=begins("slope_s_m", threshold_m_s=0.0),
    beside=where_alike("threshold_m_s", absent={"slope_s_m": 0.0}),
    starts=starts,
    remedy="clean the surface of {place}, give it more wrap or nip, or run slower",
    forms=(
        Form(
            strengths=("slope_s_m",),
            sign=1,
            text=(
                "the web slips on a driven roller above a speed and runs slower than it: tension "
                "drops before the roller and rises behind it, where no loop holds it"
            ),
        ),
        Form(
            strengths=("slope_s_m",),
            sign=-1,
            text=(
                "the web slips on a driven roller above a speed and is pulled ahead of it: "
                "tension rises before the roller and drops behind it, where no loop holds it"
            ),
        ),
    ),
)
