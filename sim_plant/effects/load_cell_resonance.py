"""A load-cell roller that swings on its mounts."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Parameter, Value
from sim_plant.effects.beside import where_alike


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Put a second-order resonance before the amplifier filter of cell ``place``.

    out'' + 2 zeta w out' + w^2 out = w^2 in   [own; single mass on the cell's spring]. For slow
    signals the change goes with 1 / w^2; 0 Hz is a stiff mount.
    """
    cell = arrays.cells[place]
    if float(parameters["frequency_Hz"]) != 0.0:
        cell["resonance_Hz"] = float(parameters["frequency_Hz"])
        cell["resonance_damping"] = float(parameters["damping"])
    return arrays


EFFECT = Effect(
    name="load_cell_resonance",
    place="cell",
    candidates="cell",
    accepts={
        "frequency_Hz": Parameter(
            default=0.0,
            unit="Hz",
            typical=12.0,
            low=0.0,
            high=200.0,
            tries=(2.2, 2.7, 3.3, 4.0, 5.0, 6.5, 8.5, 11.0, 15.0, 22.0, 30.0),
        ),
        "damping": Parameter(
            default=0.05, unit="1", typical=0.05, low=0.001, high=1.0, role="shape"
        ),
    },
    fitted=("frequency_Hz", "damping"),
    apply=apply,
    text="a load cell rings on its mounts: one frequency is amplified in its reading",
    shows=None,
    beside=where_alike(absent={"frequency_Hz": 0.0}),
    remedy="look for loose mounts at {place}",
)
