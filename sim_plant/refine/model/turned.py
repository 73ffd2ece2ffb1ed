"""The parameters of an effect whose body stands at another angle when a record begins."""

from __future__ import annotations

import math

from sim_plant.base.effects import Effect, Value
from sim_plant.base.signatures import Frequency


def turned(effect: Effect, values: dict[str, Value], angle_rad: float) -> dict[str, Value]:
    """Return parameters of the same effect with its body turned ``angle_rad`` further at start.

    The k-th pair of a cosine and a sine part is order k, or the order that it names; of an effect
    that shows at a frequency in time every pair is order 1.
    """
    parameters = dict(values)
    for k, pair in enumerate(effect.quadratures, start=1):
        order = 1.0 if isinstance(effect.shows, Frequency) else float(k)
        if pair.order:
            order = float(values.get(pair.order, effect.parameters[pair.order]))
        further_rad = (-order if pair.against else order) * angle_rad
        if pair.angle in parameters:
            parameters[pair.angle] = float(parameters[pair.angle]) + further_rad
        if pair.cos not in parameters and pair.sin not in parameters:
            continue
        phasor = complex(*(float(parameters.get(name, 0.0)) for name in (pair.cos, pair.sin)))
        phasor *= complex(math.cos(further_rad), math.sin(further_rad))
        parameters[pair.cos], parameters[pair.sin] = phasor.real, phasor.imag
    of_pairs = {pair.angle for pair in effect.quadratures}
    for name, value in values.items():
        if effect.accepts[name].role == "angle" and name not in of_pairs:
            parameters[name] = float(value) + angle_rad
    return parameters
