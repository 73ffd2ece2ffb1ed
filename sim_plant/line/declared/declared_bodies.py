"""Sections of a declaration for what moves rollers and what warms the web.

A *carriage* is what a dancer's or an accumulator's rollers are mounted on: it has one travel, in
m, 0 where the file puts the rollers, positive where it lengthens the web's path. A dancer on an
arm has it along the circle of its first roller.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from sim_plant.line.declared.sections import Finite, Name, NotNegative, Positive, Section

Rollers = Annotated[tuple[Name, ...], Field(min_length=1)]
"""Names of idlers, in web order."""


class LinearDancer(Section):
    """Rollers on a carriage that slides along a straight line."""

    name: Name
    kind: Literal["linear"]
    rollers: Rollers
    mass_kg: Positive = Field(description="of all that moves along: rollers, carriage, piston")
    weight_N: NotNegative | None = Field(
        default=None, description="what gravity pulls at it; left out: mass_kg times 9.80665 m/s2"
    )
    direction_deg: Finite = Field(description="of its travel, which lengthens the path")
    load_N: Finite = Field(description="along the travel, against the web: cylinder, spring, rope")
    stiffness_N_m: NotNegative = Field(default=0.0, description="spring, unloaded at travel 0")
    damping_N_s_m: NotNegative = 0.0
    friction_N: NotNegative = 0.0
    travel_m: tuple[Finite, Finite] = Field(description="from stop to stop")


class PendulumDancer(Section):
    """Rollers on an arm that swings about a pivot."""

    name: Name
    kind: Literal["pendulum"]
    rollers: Rollers
    inertia_kg_m2: Positive = Field(description="about the pivot, rollers as points of mass")
    weight_N: NotNegative = Field(description="of arm and rollers, at the first roller's centre")
    pivot_x_m: Finite
    pivot_y_m: Finite
    rotation: Literal["ccw", "cw"] = Field(description="of the arm where the path grows longer")
    load_N_m: Finite = Field(description="about the pivot, against the web: cylinder, spring")
    stiffness_N_m_rad: NotNegative = Field(default=0.0, description="unloaded at travel 0")
    damping_N_m_s: NotNegative = 0.0
    friction_N_m: NotNegative = 0.0
    travel_m: tuple[Finite, Finite] = Field(
        description="from stop to stop, along the circle of the first roller's centre"
    )


Dancer = Annotated[LinearDancer | PendulumDancer, Field(discriminator="kind")]


class CarriageDrive(Section):
    """Speed PI of an accumulator's own drive: a winch, or a cylinder under a servo valve."""

    K_ref_rad_s: Positive
    zeta: Positive
    force_limit_N: Positive


class CarriageMove(Section):
    """A speed of the carriage for a time, from the start of a record on."""

    from_s: NotNegative
    until_s: Positive
    rise_s: NotNegative = 0.0
    speed_m_s: Finite


class Accumulator(Section):
    """Rollers on a carriage that stores web: positive travel fills it."""

    name: Name
    rollers: Rollers
    mass_kg: Positive = Field(description="of all that moves along, counterweights too")
    weight_N: NotNegative | None = Field(
        default=None, description="what gravity pulls at it; left out: mass_kg times 9.80665 m/s2"
    )
    direction_deg: Finite = Field(description="of its travel, which lengthens the path")
    lift_N: Finite = Field(
        description="along the travel, against the web: cylinder, counterweight"
    )
    damping_N_s_m: NotNegative = 0.0
    friction_N: NotNegative = 0.0
    travel_m: tuple[Finite, Finite] = Field(description="from stop to stop")
    drive: CarriageDrive | None = None
    schedule: tuple[CarriageMove, ...] = ()


class PositionPi(Section):
    """Loop that holds a dancer or accumulator at a travel by the speed of a drive.

    v_correction = +-(gain*e + gain*corner*integral(e)), e = position_m - travel: plus where the
    drive feeds the carriage, minus where it takes web out of it. It runs with the tension loops.
    """

    loop: Name
    acts_on: Name
    carriage: Name
    position_m: Finite = 0.0
    gain_m_s_per_m: Positive
    corner_rad_s: Positive


class HeatedSpan(Section):
    """A span through an oven or past a cooler, in sections of equal length.

    Temperatures count from that of the web on the unwind. Behind the first heated span the web
    goes towards the temperature of the room, with ``web.room_exchange_s``.
    """

    name: Name
    start: Name
    end: Name
    warming_K: Annotated[tuple[Finite, ...], Field(min_length=1, max_length=32)] = Field(
        description="surroundings of each section over the temperature of the web on the unwind"
    )
    exchange_s: Positive = Field(
        description="time constant of the web in them: density*heat capacity*thickness over the "
        "sum of both sides' heat transfer"
    )


def section_of(carriage: LinearDancer | PendulumDancer | Accumulator) -> str:
    """Return the section of a line file that a carriage stands in."""
    return "accumulators" if isinstance(carriage, Accumulator) else "dancers"


def carriage_numbers(
    carriage: LinearDancer | PendulumDancer | Accumulator,
) -> tuple[tuple[str, str, str], ...]:
    """Return the numbers of a carriage that may be wrong: key, field of ``CARRIAGE``, kind."""
    if isinstance(carriage, PendulumDancer):
        keys = ("inertia_kg_m2", "load_N_m", "stiffness_N_m_rad", "damping_N_m_s", "friction_N_m")
    else:
        load = "lift_N" if isinstance(carriage, Accumulator) else "load_N"
        keys = ("mass_kg", load, "stiffness_N_m", "damping_N_s_m", "friction_N")
    fields = ("mass_kg", "load_N", "stiffness_N_m", "damping_N_s_m", "friction_N")
    kinds = ("carriage_mass", "carriage_load", "carriage_load", "carriage_drag", "carriage_drag")
    rows = zip(keys, fields, kinds, strict=True)
    return tuple(row for row in rows if row[0] in type(carriage).model_fields)
