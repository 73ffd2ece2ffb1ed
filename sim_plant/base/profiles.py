"""Named profiles: an effect found order by order, said again by size, angle and a name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from sim_plant.base.arrays import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """One profile to start a fit from.

    Attributes
    ----------
    choice : options (name, value), its own name among them.
    names, start : numbers to fit, and where they begin.
    """

    choice: tuple[tuple[str, float | str], ...]
    names: tuple[str, ...]
    start: tuple[float, ...]


Starts = Callable[[float, Array, Array, Sequence[float]], list[Profile]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Profiles:
    """How tracing gets from the orders of an effect to its named profiles.

    Attributes
    ----------
    starts : (mean radius of the body, m; S'PS (n, n) and S'Pr (n,) of the order columns S; size
        of each column) -> the profiles that explain most, best first.
    size : the parameter that a named profile has and a mix of orders does not.
    age : the parameter that says by how much the body has changed since its profile was formed:
        a state of the body, found anew on every record.
    age_tries : values of it to begin a fit with.
    orders_choice : options (name, value) of a mix of orders, as traced.
    nearest : (mean radius of the body, m; cos and sin of its orders, m (n, 2)) -> of each name
        the profile that is most like them, the best first.
    orders : (mean radius of the body, m; options and numbers of a profile; n) -> cos and sin of
        its first n orders, m (n, 2).
    """

    starts: Starts
    size: str
    age: str
    age_tries: tuple[float, ...]
    orders_choice: tuple[tuple[str, float | str], ...]
    nearest: Callable[[float, Array], list[Profile]]
    orders: Callable[[float, Mapping[str, float | str], int], Array]
