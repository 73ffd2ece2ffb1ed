"""Mains pick-up on a load-cell cable."""

from __future__ import annotations

import cmath
from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Parameter, Quadrature, Value
from sim_plant.base.signatures import Frequency
from sim_plant.effects.beside import where_alike
from sim_plant.effects.experiments import of_the_cell
from sim_plant.effects.phasor import amplitude, angle, component, phasor

PAIR = Quadrature(cos="cos_N", sin="sin_N", amplitude="amplitude_N", angle="phase_rad")
MAINS_HZ = (50.0, 60.0, 100.0, 120.0)
"""Mains, and what a rectifier makes of them. At 1 % higher harmonics fold onto every slow line of
a record at 10 ms: 400 Hz alone onto all from 0 to 4 Hz, where dancers and loops swing."""
STEP_HZ = 1e-4
"""Of a finite difference: a twentieth of a turn after five minutes, a slope and no chord."""
DECIMALS = 6
"""Of a frequency in Hz: one that folds to 0 is told as 0."""
MOST_CELLS = 8
OTHERS = tuple(Quadrature(cos=f"cos_{k}_N", sin=f"sin_{k}_N") for k in range(1, MOST_CELLS))
"""What the cell of this number, as the line declares them, has more than ``PAIR``."""


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Add cos(2 pi f t) and sin(2 pi f t) to the sampled word of cell ``place``, after its filter.

    The word is taken at the record's sample instants, so a line above half the sample rate
    appears at its alias |f - k f_s|; t counts from the start of the record. Words that a scan
    takes one after another have phases of their own: of the second cell that the
    line declares and those after it, ``cos_1_N`` and so on are added.
    """
    hum_N = phasor(parameters, PAIR)
    if 0 < place < MOST_CELLS:
        hum_N += phasor(parameters, OTHERS[place - 1])
    if hum_N != 0.0:
        cell = arrays.cells[place]
        # c cos + s sin = A cos(w t - angle)
        if cell["hum_N"] != 0.0:  # of the same frequency
            hum_N += cmath.rect(float(cell["hum_N"]), -float(cell["hum_phase_rad"]))
        cell["hum_N"], cell["hum_phase_rad"] = abs(hum_N), -cmath.phase(hum_N)
        cell["hum_Hz"] = float(parameters["frequency_Hz"])
    return arrays


def seen(values: Mapping[str, Value], sample_time_s: float) -> str:
    """Return which frequency the readings show, and what else folds to it; "" where none does.

    Equation: |f - k f_s|, k the nearest whole number, and k f_s -+ that for every k  [sampling];
    told for 1, 2 and the nearest.
    """
    hertz, rate_Hz = float(values["frequency_Hz"]), 1.0 / sample_time_s
    if hertz <= 0.5 * rate_Hz:
        return ""
    nearest = round(hertz / rate_Hz)
    shown_Hz = round(abs(hertz - rate_Hz * nearest), DECIMALS)
    folds = sorted({1, 2, nearest})
    alike = (k * rate_Hz + side for k in folds for side in (-shown_Hz, shown_Hz))
    texts = dict.fromkeys((f"{shown_Hz:.3g}", *(f"{f:.5g}" for f in alike)))
    return (
        f"the readings show {shown_Hz:.3g} Hz, folded by their sampling at {rate_Hz:.4g} Hz: "
        f"{', '.join(texts)} Hz look the same; read the cell with the web "
        "off, or sample faster, to tell which"
    )


EFFECT = Effect(
    name="mains_hum",
    place="cell",
    candidates="cell",
    accepts={
        "frequency_Hz": Parameter(
            default=50.0, unit="Hz", typical=50.0, low=10.0, high=500.0, role="shape", step=STEP_HZ
        ),
        "cos_N": component("N", 0.5, 100.0),
        "sin_N": component("N", 0.5, 100.0),
        "amplitude_N": amplitude("N", 0.5, 100.0),
        "phase_rad": angle(),
        **{
            name: component("N", 0.5, 100.0, detail=True)
            for pair in OTHERS
            for name in (pair.cos, pair.sin)
        },
    },
    fitted=("cos_N", "sin_N", "frequency_Hz"),
    fitted_per_place=("cos_{k}_N", "sin_{k}_N"),
    quadratures=(PAIR, *OTHERS),
    pairs="cells",
    apply=apply,
    text="mains pick-up in a reading: a line in time, often an alias, that no roller explains",
    shows=Frequency(at=lambda values: float(values["frequency_Hz"]), near_Hz=MAINS_HZ),
    remedy="look at shield and earth of the cable of {place}",
    experiment=of_the_cell,
    seen=seen,
    sensor_only=True,
    beside=where_alike(
        "frequency_Hz",
        absent={PAIR.amplitude: 0.0} | {n: 0.0 for p in (PAIR, *OTHERS) for n in (p.cos, p.sin)},
    ),
)
