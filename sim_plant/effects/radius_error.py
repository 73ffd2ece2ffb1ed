"""A drive that believes a wrong radius or gear ratio."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import REWIND, UNWIND, LineArrays
from sim_plant.base.effects import DeclaredNumber, Effect, Form, Parameter, Value


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Let drive ``place`` divide its speed reference by ``ratio`` times the true radius.

    w_ref = v_ref / (ratio R)   [own]: the roller runs slow by 1 / ratio and, at a roll, the
    inertia feed is computed for that radius. A roll's declared radius is what the drive believes
    and what is recorded, so its true one is that over ``ratio``.
    """
    ratio = float(parameters["ratio"])
    arrays.drives["radius_ratio"][place] *= ratio
    body = int(arrays.drives["body"][place])
    if int(arrays.bodies["kind"][body]) in (UNWIND, REWIND):
        arrays.bodies["radius_m"][body] /= ratio
    return arrays


def smaller(_arrays: LineArrays, _place: int) -> float:
    """Return the change of a roll's effective radius per unit of the ratio, to first order."""
    return -1.0


EFFECT = Effect(
    name="radius_error",
    place="drive",
    candidates="drive",
    accepts={
        "ratio": Parameter(default=1.0, unit="1", typical=1.002, low=0.8, high=1.25, linear=True)
    },
    fitted=("ratio",),
    apply=apply,
    text="a drive believes a wrong radius or gear ratio: its roller runs fast or slow",
    shows=None,
    remedy="put radius or gear ratio in drive {place} right",
    forms=(
        Form(
            strengths=("ratio",),
            sign=1,
            text=(
                "a drive believes too large a radius, or a wrong gear ratio: its roller runs slow"
            ),
            remedy=(
                "measure the radius of {place}: its drive believes too large a one, by what its "
                "ratio is above 1, or has a wrong gear ratio"
            ),
        ),
        Form(
            strengths=("ratio",),
            sign=-1,
            text=(
                "a drive believes too small a radius, or a wrong gear ratio: its roller runs fast"
            ),
            remedy=(
                "measure the radius of {place}: its drive believes too small a one, by what its "
                "ratio is below 1, or has a wrong gear ratio"
            ),
        ),
    ),
    declared_as=(
        # what makes a radius seem wrong is mostly a shape, which is tried itself
        DeclaredNumber(number="rollers.{place}.radius_m", parameter="ratio", proposed=False),
        DeclaredNumber(
            number="rollers.{place}.effective_radius", parameter="ratio", scale=smaller
        ),
    ),
)
