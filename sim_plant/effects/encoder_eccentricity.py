"""An encoder mounted off its shaft centre."""

from __future__ import annotations

import cmath
from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Parameter, Quadrature, Value
from sim_plant.base.signatures import whole
from sim_plant.effects.beside import where_alike
from sim_plant.effects.experiments import of_the_encoder
from sim_plant.effects.phasor import amplitude, angle, component, phasor

PAIR = Quadrature(cos="cos", sin="sin", amplitude="eccentricity", angle="angle_rad", against=True)


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Let the encoder of drive ``place`` read theta + e sin(theta + a), so speed w (1 + e cos).

    e is offset over code-wheel radius. ``loop_share`` 0: only the recorded channels see it; 1:
    the drive's speed loop acts on it too and the roller follows the false speed.
    """
    eccentricity = phasor(parameters, PAIR)
    if eccentricity != 0.0:
        drive = arrays.drives[place]
        if drive["encoder_offset_ratio"] != 0.0:  # seen by the loop alike
            old = cmath.rect(drive["encoder_offset_ratio"], -drive["encoder_angle_rad"])
            eccentricity += old
        # c cos(theta) + s sin(theta) = e cos(theta - angle)
        drive["encoder_offset_ratio"] = abs(eccentricity)
        drive["encoder_angle_rad"] = -cmath.phase(eccentricity)
        drive["encoder_loop_share"] = float(parameters["loop_share"])
    return arrays


EFFECT = Effect(
    name="encoder_eccentricity",
    place="drive",
    candidates="drive",
    accepts={
        "eccentricity": amplitude("1", 1e-3, 0.1),
        "angle_rad": angle(),
        "cos": component("1", 1e-3, 0.1),
        "sin": component("1", 1e-3, 0.1),
        "loop_share": Parameter(
            default=0.0,
            unit="1",
            typical=1.0,
            low=0.0,
            high=1.0,
            linear=True,
            role="option",
            tries=(0.0, 1.0),
        ),
    },
    fitted=("cos", "sin"),
    quadratures=(PAIR,),
    apply=apply,
    text="an encoder off its centre: its speed wobbles once per turn while the roller runs even",
    shows=whole(1),
    remedy="centre the encoder of {place} and its coupling",
    experiment=of_the_encoder,
    sensor_only=True,
    beside=where_alike("loop_share", absent={PAIR.amplitude: 0.0, PAIR.cos: 0.0, PAIR.sin: 0.0}),
)
