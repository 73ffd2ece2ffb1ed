"""What a screen needs to know of a site: names, units and limits, and nothing of its wire."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from aff_runtime.config.models import Actuator, Site


VELOCITY = "m/s"
"""Unit of a correction to a velocity reference; to a torque it is ``N m``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputFacts:
    """One actuator: a drive whose reference gets a correction.

    Attributes
    ----------
    actuator : its name in the site file.
    column : end of its columns in the record, its name with the unit: ``unwind_m_s``.
    unit : of its correction, ``m/s`` or ``N m``.
    limit : largest correction, in that unit; more than 0 of a site that passed the check.
    signal : channel whose ripple it takes out.
    reference : channel of the set point of ``signal``; empty without one.
    drive_roll : roll that its drive turns; empty where the site does not say.
    """

    actuator: str
    column: str
    unit: str
    limit: float
    signal: str
    reference: str = ""
    drive_roll: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RollFacts:
    """One roll or roller.

    Attributes
    ----------
    name : in the site file.
    radius_channel : channel of its radius, m; empty where the radius is fixed.
    radius_m : its fixed radius, m; None where a channel gives it.
    angle_channel : channel of its angle, rad; empty where its angle is not measured.
    """

    name: str
    radius_channel: str = ""
    radius_m: float | None = None
    angle_channel: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class LineFacts:
    """One line.

    Attributes
    ----------
    cycle_s : period of the control cycle, s.
    hold_after_s, fault_after_s : age of the PLC's data from which learning holds, and from which
        it is a fault, s.
    speed : channel of the line speed, m/s.
    permissives : names of the status bits without which no correction goes out.
    references : channels that are set points, not measurements.
    outputs : the actuators, in the order of the site file.
    rolls : the rolls, in the order of the site file.
    """

    cycle_s: float
    hold_after_s: float
    fault_after_s: float
    speed: str
    permissives: tuple[str, ...] = ()
    references: tuple[str, ...] = ()
    outputs: tuple[OutputFacts, ...] = ()
    rolls: tuple[RollFacts, ...] = ()

    @classmethod
    def from_json(cls, said: Any) -> LineFacts:
        """Read plain values back.

        Raises
        ------
        KeyError, TypeError
            When they are none of this release.
        """
        return cls(
            **{
                **said,
                "permissives": tuple(said["permissives"]),
                "references": tuple(said["references"]),
                "outputs": tuple(OutputFacts(**one) for one in said["outputs"]),
                "rolls": tuple(RollFacts(**one) for one in said["rolls"]),
            }
        )


def line_facts(site: Site, permissives: Sequence[str]) -> LineFacts:
    """Return the facts of a site.

    Parameters
    ----------
    site : a site file that passed the check.
    permissives : of the parameter record, in the order in which a missing one is named.
    """
    wanted = [site.line.speed_reference]
    wanted += [actuator.error.reference for actuator in site.actuators.values()]
    return LineFacts(
        cycle_s=site.cycle_s,
        hold_after_s=1e-3 * site.freshness.hold_after_ms,
        fault_after_s=1e-3 * site.freshness.fault_after_ms,
        speed=site.line.speed,
        permissives=tuple(permissives),
        references=tuple(dict.fromkeys(name for name in wanted if name)),
        outputs=tuple(_output(name, one) for name, one in site.actuators.items()),
        rolls=tuple(
            RollFacts(
                name=name,
                radius_channel=roll.radius or "",
                radius_m=roll.radius_m,
                angle_channel=roll.angle or "",
            )
            for name, roll in site.rolls.items()
        ),
    )


def _output(name: str, actuator: Actuator) -> OutputFacts:
    is_speed = actuator.unit == VELOCITY
    return OutputFacts(
        actuator=name,
        column=f"{name}_{'m_s' if is_speed else 'N_m'}",
        unit=actuator.unit,
        limit=actuator.limit,
        signal=actuator.error.signal,
        reference=actuator.error.reference or "",
        drive_roll=actuator.drive.roll if actuator.drive is not None else "",
    )
