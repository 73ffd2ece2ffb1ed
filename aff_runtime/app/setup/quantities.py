"""What has to be found among a PLC's words, in the order in which it is asked."""

from __future__ import annotations

from dataclasses import dataclass

UNWIND = "unwind"
ANGLE_UNIT = "rad"


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
    roll : of an angle or speed, whose it is.
    """

    channel: str
    unit: str
    asked: str
    optional: bool = False
    signed: bool = False
    moves: bool | None = True
    roll: str = ""


def quantities(second: str) -> tuple[Quantity, ...]:
    """Return what is looked for; ``second``: name of a second driven roller, empty without one."""
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
                channel=f"{second}_tension_N",
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
