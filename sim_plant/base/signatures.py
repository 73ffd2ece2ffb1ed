"""How an effect shows in a record: at orders of a body, at a frequency, or from a moment on.

What shows as a line is looked for only where the record has one, and has to explain that line.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

Values = Mapping[str, float | str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Orders:
    """A response that repeats with the angle of the body at the effect's location.

    Attributes
    ----------
    at : (parameters, mean radius of that body, m) -> cycles per turn, never empty; not whole
        where something turns along at a ratio of its own.
    resonant : something rings at the order, so size and phase change with speed. Such an effect
        is tried when those that stand still over the angle have been.
    """

    at: Callable[[Values, float], tuple[float, ...]]
    resonant: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Frequency:
    """A response that repeats in time, whatever the speed.

    ``at`` : (parameters) -> frequency before sampling, Hz.
    """

    at: Callable[[Values], float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Onset:
    """A response that is there from a moment of this record on; no line.

    ``at`` : (parameters) -> length of unstretched web unwound by then, m.
    """

    at: Callable[[Values], float]


Signature = Orders | Frequency | Onset


def whole(*orders: int) -> Orders:
    """Return the signature of an effect that always shows at these orders of its body."""
    fixed = tuple(float(order) for order in orders)
    return Orders(at=lambda _values, _radius_m: fixed)


def said_by(parameter: str, *, resonant: bool = False) -> Orders:
    """Return the signature of an effect that shows at the order one of its parameters says."""
    return Orders(at=lambda values, _radius_m: (float(values[parameter]),), resonant=resonant)
