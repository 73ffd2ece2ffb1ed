"""What an effect is: a named change of the line's arrays, shared by simulation and tracing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from sim_plant.base.arrays import LineArrays

Place = Literal["body", "drive", "cell", "web", "span", "loop"]
Value = float | str
Apply = Callable[[LineArrays, int, Mapping[str, Value]], LineArrays]


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """One catalogue row.

    Attributes
    ----------
    name : as in declarations and verdicts.
    place : what a location names: a body, a drive, a load cell, the web, a span, a tension loop.
    parameters : defaults, SI; the keys are the only ones accepted. At the default the effect is
        exactly absent.
    apply : returns arrays with the effect added at the index of its place; the arrays given may
        be changed in place.
    text : one sentence for a process engineer.
    """

    name: str
    place: Place
    parameters: Mapping[str, Value]
    apply: Apply
    text: str
