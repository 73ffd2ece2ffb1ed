"""Read a pair of components, or amplitude and angle, or both, as one complex number."""

from __future__ import annotations

import cmath
from collections.abc import Mapping

from sim_plant.base.effects import Parameter, Quadrature, Value


def phasor(parameters: Mapping[str, Value], pair: Quadrature) -> complex:
    """Return cos + j sin = A exp(j angle); polar and Cartesian parts add."""
    total = complex(float(parameters[pair.cos]), float(parameters[pair.sin]))
    if pair.amplitude and float(parameters[pair.amplitude]) != 0.0:
        total += cmath.rect(float(parameters[pair.amplitude]), float(parameters[pair.angle]))
    return total


def component(unit: str, typical: float, limit: float, *, detail: bool = False) -> Parameter:
    """Return one component of a phasor: linear, either sign, absent at 0."""
    return Parameter(
        default=0.0, unit=unit, typical=typical, low=-limit, high=limit, linear=True, detail=detail
    )


def amplitude(unit: str, typical: float, limit: float) -> Parameter:
    """Return the amplitude of a phasor: not negative, linear, absent at 0."""
    return Parameter(default=0.0, unit=unit, typical=typical, low=0.0, high=limit, linear=True)


def angle() -> Parameter:
    """Return the angle that belongs to an amplitude."""
    return Parameter(default=0.0, unit="rad", typical=1.0, role="angle")
