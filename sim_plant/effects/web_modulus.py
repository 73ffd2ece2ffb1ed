"""A web stiffer or softer than declared."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import DeclaredNumber, Effect, Form, Parameter, Value


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Multiply EA of every span; the roll was wound at the same tension, so at another strain.

    T = factor EA (strain - free strain)   [Hooke, source before 2.21]
    """
    factor = float(parameters["factor"])
    arrays.spans["EA_N"] *= factor
    arrays.web["supply_strain"] /= factor
    return arrays


EFFECT = Effect(
    name="web_modulus",
    place="web",
    candidates="web",
    accepts={
        "factor": Parameter(default=1.0, unit="1", typical=0.9, low=0.3, high=3.0, linear=True)
    },
    fitted=("factor",),
    apply=apply,
    text="the web is stiffer or softer than declared: draw zones hold another tension",
    shows=None,
    remedy="measure the stiffness of the web and put web.EA_N of the declaration right",
    forms=(
        Form(
            strengths=("factor",),
            sign=1,
            text="the web is stiffer than declared: the same draw pulls it tighter",
        ),
        Form(
            strengths=("factor",),
            sign=-1,
            text="the web is softer than declared: the same draw pulls it less",
        ),
    ),
    declared_as=(DeclaredNumber(number="web.EA_N", parameter="factor"),),
)
