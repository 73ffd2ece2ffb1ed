"""How an effect shows in a record: at orders of a body, at a frequency, or from a moment on.

What shows as a line is looked for only where the record has one, and has to explain that line.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

Values = Mapping[str, float | str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Orders:
    """A response that repeats with the angle of the body at the effect's location.

    Attributes
    ----------
    at : (parameters, mean radius of that body, m) -> cycles per turn, never empty; not whole
        where something turns along at a ratio of its own.
    rings_at, damped_by : parameters that say at which frequency, Hz, something rings that the
        order excites, and its damping ratio: size and phase change with speed. Such an effect
        is tried when those that stand still over the angle have been. Empty where nothing does.
    parameter : the one that says the only order, empty where none does.
    rolls_on : the radius, m, of what turns along with that body without a slip, as the parameter
        of this name: it shows at the ratio of the radii. Empty where nothing does.
    """

    at: Callable[[Values, float], tuple[float, ...]]
    rings_at: str = ""
    damped_by: str = ""
    parameter: str = ""
    rolls_on: str = ""

    @property
    def resonant(self) -> bool:
        """Whether something rings at the order."""
        return bool(self.rings_at)


@dataclass(frozen=True, slots=True, kw_only=True)
class Frequency:
    """A response that repeats in time, whatever the speed.

    Attributes
    ----------
    at : (parameters) -> frequency before sampling, Hz.
    parameter : the one that says it.
    near_Hz : it is found within ``width`` of one of these where it was not folded, else only as
        near as a grid is; empty: anywhere.
    width : relative.
    """

    at: Callable[[Values], float]
    parameter: str = "frequency_Hz"
    near_Hz: tuple[float, ...] = ()
    width: float = 0.01


@dataclass(frozen=True, slots=True, kw_only=True)
class Onset:
    """A form of an effect that is there from a moment of one record on; no line of its own.

    Attributes
    ----------
    moment : the parameter that says when.
    unit : of the moment: ``s`` of the record, or ``m`` of unstretched web unwound since it began.
    forms : parameters that are fitted with the moment, per way to begin.
    fixed : parameters that such a form needs at other values than their defaults.
    grid : values of its shapes that a search begins from, one shape after the other.
    """

    moment: str
    unit: Literal["s", "m"]
    forms: tuple[tuple[str, ...], ...]
    fixed: tuple[tuple[str, float | str], ...] = ()
    grid: tuple[tuple[str, tuple[float, ...]], ...] = ()


Signature = Orders | Frequency


def whole(*orders: int) -> Orders:
    """Return the signature of an effect that always shows at these orders of its body."""
    fixed = tuple(float(order) for order in orders)
    return Orders(at=lambda _values, _radius_m: fixed)


def said_by(parameter: str, *, rings_at: str = "", damped_by: str = "") -> Orders:
    """Return the signature of an effect that shows at the order one of its parameters says.

    ``rings_at`` and ``damped_by`` are parameters of a resonance that the order excites.
    """
    return Orders(
        at=lambda values, _radius_m: (float(values[parameter]),),
        rings_at=rings_at,
        damped_by=damped_by,
        parameter=parameter,
    )


def once_per_turn_of(radius: str) -> Orders:
    """Return the signature of what rolls on a body: once per turn of its own.

    ``radius`` is the parameter that says its radius, m.
    """
    return Orders(at=lambda values, radius_m: (radius_m / float(values[radius]),), rolls_on=radius)
