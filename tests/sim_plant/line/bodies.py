"""Lines with dancers, accumulators and heated spans to test on, and changes of them."""

from __future__ import annotations

from typing import Any

import numpy as np

from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.running.simulation import LineSimulation
from tests.sim_plant.line.lines import declared, exact_line

SPEED_M_S, TENSION_N = 2.0, 90.0
TICK_S = 1e-3


def coater(**changed: Any) -> Declaration:
    """Return the shipped line with a dancer, an oven and an accumulator, with other sections."""
    return declared("coater").model_copy(update=changed)


def declared_anew(line: Declaration, **changed: Any) -> Declaration:
    """Return a declaration with other sections, checked as a file's; given as a file has them."""
    data = line.model_dump(by_alias=True, exclude_none=True) | changed
    return Declaration.model_validate(_lists_as_tuples(data))


def _lists_as_tuples(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _lists_as_tuples(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return tuple(_lists_as_tuples(value) for value in data)
    return data


def exact_coater(line: Declaration | None = None, **options: Any) -> LineSimulation:
    """Return that line without noise, rolls that keep their radius, settled a little."""
    made: LineSimulation = exact_line(line or coater(), speed_m_s=SPEED_M_S, **options)
    return made


def circles(line: LineSimulation, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # type: ignore[type-arg]
    """Return length, direction and centres of every span in a state, of circles.

    From the declaration: a straight travel along its direction, an arm about its pivot.
    """
    declaration, lay = line.declaration, line.layout
    centres = np.array([complex(r.center_x_m, r.center_y_m) for r in declaration.rollers])
    for k, roller in enumerate(declaration.rollers):
        c = declaration.carriage_of(roller.name)
        if c < 0:
            continue
        given, travel = declaration.carriages[c], y[lay.carriage + 2 * c]
        if hasattr(given, "direction_deg"):
            centres[k] += travel * np.exp(1j * np.radians(given.direction_deg))
        else:
            pivot = complex(given.pivot_x_m, given.pivot_y_m)
            arm = abs(complex(*_first(declaration, given)) - pivot)
            turn = travel / arm * (1.0 if given.rotation == "ccw" else -1.0)
            centres[k] = pivot + (centres[k] - pivot) * np.exp(1j * turn)
    radius = line.arrays.bodies["radius_m"].copy()
    radius[0], radius[-1] = y[lay.radius : lay.radius + 2]
    apart = np.diff(centres)
    reach = np.diff(line.arrays.bodies["sigma"] * radius)
    length = np.sqrt(np.abs(apart) ** 2 - reach**2)
    return length, np.angle(apart) - np.arcsin(reach / np.abs(apart)), centres


def _first(declaration: Declaration, given: Any) -> tuple[float, float]:
    roller = declaration.rollers[declaration.body(given.rollers[0])]
    return roller.center_x_m, roller.center_y_m
