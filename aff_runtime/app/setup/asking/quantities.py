"""What has to be found among a PLC's words, in the order in which it is asked."""

from __future__ import annotations

from dataclasses import dataclass

from aff_runtime.base.channel_units import unit_of_channel

UNWIND = "unwind"
ANGLE_UNIT = "rad"
SPEED_SET = "line_speed_ref_m_s"
_SET = "_ref_"  # part of the name of a set point


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """One measured value or set point.

    Attributes
    ----------
    channel : its name in the site file; the end is its SI ``unit``.
    asked : what the technician reads off the display.
    optional : whether a line may do without.
    signed : whether its word is called signed where nothing tells.
    moves : True when it is measured, False when it is set, None when it moves slowly.
    roll : whose angle it is; empty for any other quantity.
    recorded : whether it is for the record alone, and left out where nothing is typed.
    """

    channel: str
    unit: str
    asked: str
    optional: bool = False
    signed: bool = False
    moves: bool | None = True
    roll: str = ""
    recorded: bool = False


def tension_of(roll: str) -> str:
    """Return the usual channel of the web tension behind a roll."""
    return f"{roll}_tension_N"


def quantities(second: str, second_tension: str = "") -> tuple[Quantity, ...]:
    """Return what is looked for.

    Parameters
    ----------
    second : name of a second driven roller, empty without one.
    second_tension : channel of the tension behind it; by itself named after the roller.
    """
    found: tuple[Quantity, ...] = (
        Quantity(
            channel="unwind_tension_N",
            unit="N",
            asked="web tension behind the unwind",
            signed=True,
        ),
        Quantity(
            channel="tension_ref_N",
            unit="N",
            asked="set point of that tension",
            optional=True,
            moves=False,
        ),
        Quantity(channel="line_speed_m_s", unit="m/s", asked="line speed", signed=True),
        Quantity(
            channel=SPEED_SET,
            unit="m/s",
            asked="set point of the line speed behind its ramp",
            optional=True,
            signed=True,
            moves=False,
            recorded=True,
        ),
        Quantity(
            channel="unwind_radius_m",
            unit="m",
            asked="radius of the unwind roll (half its diameter)",
            moves=None,
        ),
    )
    if second:
        found += (
            Quantity(
                channel=f"{second}_speed_m_s",
                unit="m/s",
                asked=f"speed of {second}",
                optional=True,
                signed=True,
            ),
            Quantity(
                channel=second_tension or tension_of(second),
                unit="N",
                asked=f"web tension behind {second}",
                signed=True,
            ),
        )
    return found


def angles(second: str) -> tuple[Quantity, ...]:
    """Return the angles that are looked for."""
    return tuple(
        Quantity(
            channel=f"{roll}_angle_rad",
            unit=ANGLE_UNIT,
            asked=f"encoder of {roll}",
            optional=True,
            signed=True,
            roll=roll,
        )
        for roll in ((UNWIND, second) if second else (UNWIND,))
    )


def further(channel: str) -> Quantity:
    """Return a channel to record beside what is corrected; its name ends with its SI unit.

    A channel with ``_ref_`` in its name is set; a length, such as a radius, moves slowly.
    """
    unit = unit_of_channel(channel) or ""
    return Quantity(
        channel=channel,
        unit=unit,
        asked=channel,
        optional=True,
        signed=unit != "m",
        moves=None if unit == "m" else _SET not in channel,
        recorded=True,
    )
