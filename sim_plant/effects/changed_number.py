"""A declared number that becomes another one at a moment of the record."""

from __future__ import annotations

from collections.abc import Mapping

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import LineArrays, copy_arrays
from sim_plant.base.effects import Effect, Parameter, Shift, Value
from sim_plant.effects.onset import (
    FROM,
    begins,
    begins_later,
    changes_only_numbers,
    with_difference,
)


def apply(arrays: LineArrays, shift: Shift, parameters: Mapping[str, Value]) -> LineArrays:
    """Move a declared number by ``change`` from ``from_s`` on, or from the start   [own].

    The line runs on from the state that it has then: web keeps its strain, a drive its torque.
    """
    change = float(parameters["change"])
    if change == 0.0:
        return arrays
    if not begins_later(parameters):
        return shift(arrays, change)
    moved = shift(copy_arrays(arrays), change)
    if not changes_only_numbers(arrays, moved):
        raise PlantError(
            "this number is read once, when a run begins: it can be another one from the start, "
            "but not from a moment on; leave out from_s"
        )
    return with_difference(arrays, moved, parameters)


def among(places: str) -> str:
    """Return what tells which of several numbers changed."""
    return (
        f"look up in the logs of drives and PLC, and ask, which of {places} was changed then, and "
        "change that one on purpose while you record"
    )


def looked_up(place: str, _other: Effect, _there: str) -> str:
    """Return what tells a number that was changed from anything else that began then."""
    return f"look up in the logs of drives and PLC, and ask, whether {place} was changed then"


EFFECT = Effect(
    name="changed_number",
    place="number",
    candidates="number",
    accepts={
        "change": Parameter(default=0.0, unit="1", typical=0.02, low=-1e4, high=1e4, linear=True),
        "from_s": FROM,
    },
    fitted=(),
    apply=apply,
    shifted_by="change",
    text="a number of the line is another one from a moment on",
    shows=None,
    onset=begins("change"),
    among=among,
    experiment=looked_up,
    remedy=(
        "ask what was done at that moment to {place}: put it back, or put the declaration right "
        "for what is recorded from then on"
    ),
)
