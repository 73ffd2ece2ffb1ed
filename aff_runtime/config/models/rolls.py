"""Section ``rolls``: the bodies whose turning makes the ripple."""

from __future__ import annotations

from typing import Literal

from aff_runtime.config.quantity import Metres, Name, Section, key


class Roll(Section):
    """A roll or roller; its phase comes from angle, else speed, else line speed over radius."""

    angle: Name | None = key(
        "Channel of its encoder angle (_rad); the best source of phase. Absent: the speed is "
        "integrated.",
        default=None,
    )
    speed: Name | None = key(
        "Channel of its own speed (_rad_s, or _m_s at its surface); used when no angle is given.",
        default=None,
    )
    line_speed: Name | None = key(
        "Channel of the web speed at this roll, used over the radius when neither angle nor "
        "speed is given. Absent: line.speed.",
        default=None,
    )
    radius: Name | None = key(
        "Channel of its radius (_m), for a roll that grows or shrinks. Give this or radius_m.",
        default=None,
    )
    radius_m: Metres | None = key(
        "Fixed radius. Measure it (circumference / 6.2832): 1 % of error costs phase where no "
        "angle is given.",
        default=None,
        ge=0.005,
        le=3,
    )
    radius_min_m: Metres | None = key(
        "Smallest radius that occurs (the core); required with radius. A reading below it is not "
        "taken: the last one within stays, and status says so. A range under plausibility makes "
        "it a fault.",
        default=None,
        ge=0.005,
        le=3,
    )
    radius_max_m: Metres | None = key(
        "Largest radius that occurs (the full roll); required with radius. A reading above it is "
        "not taken, as one below radius_min_m.",
        default=None,
        ge=0.005,
        le=3,
    )
    resets_on: Literal["splice", "never"] = key(
        "splice: a new roll_id or SPLICE_ACTIVE forgets what was learned of this roll. Use it "
        "for every roll that is exchanged.",
        default="never",
    )
    supplier: Name | None = key(
        "Channel of the number by which the PLC knows the supplier (or the lot) of the roll that "
        "is on (_number), 0 where it does not; for the record alone: `aff-runtime watch` ranks "
        "suppliers by how far their rolls are from round. With resets_on: splice.",
        default=None,
    )
    torque: Name | None = key(
        "Channel of the torque of its drive, at the roll (_N_m), above 0 where it drives the web "
        "on; for the record alone: `aff-runtime watch` follows the friction, which is the torque "
        "less what the tensions of the next two keys make of it.",
        default=None,
    )
    tension_before: Name | None = key(
        "Channel of the tension of the web that runs up to it (_N), for its friction; none at an "
        "unwind.",
        default=None,
    )
    tension_after: Name | None = key(
        "Channel of the tension of the web that leaves it (_N), for its friction; none at a "
        "rewind.",
        default=None,
    )
    winding: Literal["unwind", "rewind"] | None = key(
        "unwind: until the next roll its measured radius only shrinks. rewind: it only grows. "
        "What goes the other way is a fault. Absent: rewind where the roll's name begins with "
        "rewind, else unwind.",
        default=None,
    )

    def winds(self, name: str) -> bool:
        """Return whether web is wound on the roll of this name, so that its radius grows."""
        if self.winding is None:
            return name.startswith("rewind")
        return self.winding == "rewind"

    @property
    def smallest_radius_m(self) -> float:
        """Return the smallest radius that occurs, m."""
        return self.radius_m or self.radius_min_m or 0.0

    @property
    def largest_radius_m(self) -> float:
        """Return the largest radius that occurs, m."""
        return self.radius_m or self.radius_max_m or 0.0
