"""A motor or gear whose torque varies with its angle: cogging, ripple, gear mesh."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sim_plant.base.arrays import RIPPLE, LineArrays
from sim_plant.base.effects import Effect, Parameter, Quadrature, Value
from sim_plant.base.signatures import said_by
from sim_plant.effects.phasor import amplitude, angle, component, phasor

PAIR = Quadrature(
    cos="cos_N_m",
    sin="sin_N_m",
    amplitude="amplitude_N_m",
    angle="angle_rad",
    order="order",
    against=True,
)


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Add cos(n theta) and sin(n theta) torque to the motor of drive ``place``.

    tau = c cos(n theta) + s sin(n theta), n per turn of the driven roller: pole pairs or slots
    times gear ratio, or the tooth count of a mesh (not whole when a ratio is not).
    """
    ripple = phasor(parameters, PAIR)
    if ripple == 0.0:
        return arrays
    row = np.zeros(1, RIPPLE)
    row["drive"], row["order"] = place, float(parameters["order"])
    row["cos_N_m"], row["sin_N_m"] = ripple.real, ripple.imag
    return arrays._replace(ripples=np.concatenate((arrays.ripples, row)))


def experiment(place: str, _other: Effect, there: str) -> str:
    """Return what tells the motor's torque from anything else at its roller."""
    if place != there:
        return ""
    return (
        f"take the web off {place} and let it coast with its drive off: a ripple ends with "
        "the motor's torque, everything else goes on"
    )


EFFECT = Effect(
    name="torque_ripple",
    place="drive",
    candidates="drive",
    accepts={
        "order": Parameter(
            default=1.0,
            unit="1",
            typical=6.0,
            low=0.01,
            high=500.0,
            role="shape",
            tries=(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 18.0, 24.0, 36.0),
        ),
        "cos_N_m": component("N m", 0.2, 50.0),
        "sin_N_m": component("N m", 0.2, 50.0),
        "amplitude_N_m": amplitude("N m", 0.2, 50.0),
        "angle_rad": angle(),
    },
    fitted=("cos_N_m", "sin_N_m"),
    quadratures=(PAIR,),
    apply=apply,
    text="a drive pushes unevenly over its turn: ripple at a fixed number per turn of that roller",
    shows=said_by("order"),
    remedy="look at the commutation and the encoder offset of the motor of {place}",
    experiment=experiment,
    cancel_orders="order",
)
