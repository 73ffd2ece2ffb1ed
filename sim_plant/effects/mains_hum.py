"""Mains pick-up on a load-cell cable."""

from __future__ import annotations

import cmath
from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Parameter, Quadrature, Value
from sim_plant.base.signatures import Frequency
from sim_plant.effects.experiments import of_the_cell
from sim_plant.effects.phasor import amplitude, angle, component, phasor

PAIR = Quadrature(cos="cos_N", sin="sin_N", amplitude="amplitude_N", angle="phase_rad")


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Add cos(2 pi f t) and sin(2 pi f t) to the sampled word of cell ``place``, after its filter.

    The word is taken at the record's sample instants, so a line above half the sample rate
    appears at its alias |f - k f_s|; t counts from the start of the record.
    """
    hum_N = phasor(parameters, PAIR)
    if hum_N != 0.0:
        cell = arrays.cells[place]
        # c cos + s sin = A cos(w t - angle)
        cell["hum_N"], cell["hum_phase_rad"] = abs(hum_N), -cmath.phase(hum_N)
        cell["hum_Hz"] = float(parameters["frequency_Hz"])
    return arrays


EFFECT = Effect(
    name="mains_hum",
    place="cell",
    candidates="cell",
    accepts={
        "frequency_Hz": Parameter(
            default=50.0,
            unit="Hz",
            typical=50.0,
            low=10.0,
            high=500.0,
            role="shape",
            tries=(50.0, 60.0, 100.0, 120.0, 150.0, 180.0),
        ),
        "cos_N": component("N", 0.5, 100.0),
        "sin_N": component("N", 0.5, 100.0),
        "amplitude_N": amplitude("N", 0.5, 100.0),
        "phase_rad": angle(),
    },
    traced=("cos_N", "sin_N", "frequency_Hz"),
    quadratures=(PAIR,),
    apply=apply,
    text="mains pick-up in a reading: a line in time, often an alias, that no roller explains",
    shows=Frequency(at=lambda values: float(values["frequency_Hz"])),
    remedy="look at shield and earth of the cable of {place}",
    experiment=of_the_cell,
    sensor_only=True,
)
