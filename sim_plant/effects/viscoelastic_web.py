"""A web that relaxes: one Maxwell branch beside its spring."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Parameter, Value
from sim_plant.effects.beside import where_alike


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Add stress EA ratio b with db/dt = deps/dt - b/tau, carried along with the web.

    Standard linear solid; the transport of b from span to span is our own derivation, see
    ``elements/span.py``.
    """
    arrays.web["maxwell_ratio"] += float(parameters["ratio"])
    if float(parameters["ratio"]) != 0.0:
        arrays.web["maxwell_time_s"] = float(parameters["time_s"])
    return arrays


EFFECT = Effect(
    name="viscoelastic_web",
    place="web",
    candidates="web",
    accepts={
        "ratio": Parameter(default=0.0, unit="1", typical=0.1, low=0.0, high=5.0, linear=True),
        "time_s": Parameter(
            default=1.0,
            unit="s",
            typical=1.0,
            low=0.02,
            high=100.0,
            role="shape",
            tries=(0.1, 0.3, 1.0, 3.0),
        ),
    },
    fitted=("ratio", "time_s"),
    apply=apply,
    text="the web relaxes: tension creeps back after every change of strain",
    shows=None,
    beside=where_alike("time_s", absent={"ratio": 0.0}),
    remedy="keep to the amended line; this web creeps, no setting is wrong",
)
