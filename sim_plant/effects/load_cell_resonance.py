"""A load-cell roller that swings on its mounts."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Demand, Effect, Parameter, Start, Value
from sim_plant.effects.beside import where_alike

DAMPING = 0.05
SOFTEST_HZ = 1.5
"""Where a search begins: softer, a roller would sag by more than g / (2 pi f)^2 = 0.11 m of its
own weight."""
LISTED_HZ = 30.0
"""Up to here whatever the record; from here on as far as it shows."""


def grid_Hz() -> Iterator[float]:
    """Yield frequencies, rising, one of them within two half widths of every one of a cell.

    Equation: f_k = f_0 q^k, q = 1 + 4 zeta  [own; as what rings at an order, see half_widths of
    refine's criteria].
    """
    return (SOFTEST_HZ * (1.0 + 4.0 * DAMPING) ** k for k in itertools.count())


TRIES_HZ = tuple(itertools.takewhile(lambda f: f <= LISTED_HZ, grid_Hz()))


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


def starts(_arrays: LineArrays, _place: int, demand: Demand) -> list[Start]:
    """Return the frequencies of the grid above those listed, as far as the records show."""
    highest_Hz = min(demand.highest_Hz, EFFECT.accepts["frequency_Hz"].high)
    shown = itertools.takewhile(lambda f: f <= highest_Hz, grid_Hz())
    return [Start(choice={"frequency_Hz": f}, acts_below={}) for f in shown if f not in TRIES_HZ]


EFFECT = Effect(
    name="load_cell_resonance",
    place="cell",
    candidates="cell",
    accepts={
        "frequency_Hz": Parameter(
            default=0.0, unit="Hz", typical=12.0, low=0.0, high=200.0, tries=TRIES_HZ
        ),
        "damping": Parameter(
            default=DAMPING, unit="1", typical=DAMPING, low=0.001, high=1.0, role="shape"
        ),
    },
    fitted=("frequency_Hz", "damping"),
    apply=apply,
    text="a load cell rings on its mounts: one frequency is amplified in its reading",
    shows=None,
    beside=where_alike(absent={"frequency_Hz": 0.0}),
    starts=starts,
    remedy="look for loose mounts at {place}",
)
