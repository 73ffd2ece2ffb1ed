"""What a screen needs to know of a site: names, units and limits, and nothing of its wire."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from aff_runtime.config.models import Actuator, Site

VELOCITY, TORQUE = "m/s", "N m"


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputFacts:
    """One actuator.

    Attributes
    ----------
    column : end of its columns in the record, with unit: ``unwind_m_s``.
    unit : of its correction, m/s or N m. ``limit`` : largest correction, in that unit.
    signal : channel that it keeps quiet. ``reference`` : its set point, empty without one.
    drive_roll : roll that its drive turns, empty where the site does not say.
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
    """One roll: the channel of its radius, or its fixed radius, m; the channel of its angle."""

    name: str
    radius_channel: str = ""
    radius_m: float | None = None
    angle_channel: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class LineFacts:
    """One line.

    Attributes
    ----------
    cycle_s : period of the control cycle.
    hold_after_s, fault_after_s : age of the PLC's data from which learning holds; from which it
        is a fault.
    speed : channel of the line speed. ``permissives`` : status bits that are needed.
    references : channels that are set points, not measurements.
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
    is_speed = actuator.output == "velocity_reference"
    limit = actuator.limit_m_s if is_speed else actuator.limit_N_m
    return OutputFacts(
        actuator=name,
        column=f"{name}_{'m_s' if is_speed else 'N_m'}",
        unit=VELOCITY if is_speed else TORQUE,
        limit=limit or 0.0,
        signal=actuator.error.signal,
        reference=actuator.error.reference or "",
        drive_roll=actuator.drive.roll if actuator.drive is not None else "",
    )
