"""A roll wound tighter or looser than declared."""

from __future__ import annotations

from collections.abc import Mapping

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import UNWIND, LineArrays
from sim_plant.base.effects import DeclaredNumber, Effect, Form, Parameter, Value


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Add ``strain`` to the strain at which web leaves the unwind   [eps_0 of source 2.20].

    The roll then turns by d eps / (1 + eps) faster or slower at the same line speed.
    """
    if int(arrays.bodies["kind"][place]) != UNWIND:
        raise PlantError("wound_in_strain.location: web leaves the unwind only")
    arrays.web["supply_strain"] += float(parameters["strain"])
    return arrays


def bounds(arrays: LineArrays, place: int) -> dict[str, tuple[float, float]]:
    """Return the change at which the roll would have been wound with no strain at all."""
    return {"strain": (-float(arrays.web["supply_strain"][0]), 0.02)}


def share(arrays: LineArrays, place: int) -> float:
    """Return the change of the declared winding tension per unit of strain, a share of it."""
    return 1.0 / float(arrays.web["supply_strain"][0])


def turning(arrays: LineArrays, place: int) -> float:
    """Return the effective radius that turns alike, per unit of strain, relative.

    R w / (1 + eps_0) feeds the line, so more strain is less radius   [source 2.20].
    """
    return -1.0 / (1.0 + float(arrays.web["supply_strain"][0]))


EFFECT = Effect(
    name="wound_in_strain",
    place="body",
    candidates="unwind",
    accepts={
        "strain": Parameter(
            default=0.0, unit="1", typical=0.001, low=-0.02, high=0.02, linear=True
        )
    },
    fitted=("strain",),
    apply=apply,
    bounds=bounds,
    text="the roll was wound tighter or looser: it turns at another speed for the same web",
    shows=None,
    remedy="ask how tight the roll at {place} was wound; put web.wound_in_tension_N right",
    forms=(
        Form(
            strengths=("strain",),
            sign=1,
            text="the roll was wound tighter than declared: it turns faster for the same web",
        ),
        Form(
            strengths=("strain",),
            sign=-1,
            text="the roll was wound looser than declared: it turns slower for the same web",
        ),
    ),
    declared_as=(
        DeclaredNumber(number="web.wound_in_tension_N", parameter="strain", scale=share),
        # the roll turns as one of another radius would; only its inertia tells
        DeclaredNumber(
            number="rollers.{place}.effective_radius", parameter="strain", scale=turning
        ),
    ),
)
