"""The whole site file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from aff_runtime.config.models.actuators import Actuator
from aff_runtime.config.models.gateway import Gateway
from aff_runtime.config.models.guard import Freshness, Permissives, PlausibleRange
from aff_runtime.config.models.rolls import Roll
from aff_runtime.config.models.service import Probe, RecordingSettings
from aff_runtime.config.quantity import (
    Few,
    MetresPerSecond,
    Milliseconds,
    Name,
    Section,
    Text,
    Whole,
    key,
)


class Line(Section):
    """The line as a whole."""

    name: Text = key("Name of the line, for records and screens.")
    cycle_ms: Milliseconds = key(
        "Period of the control cycle. Lengthen it when the PLC cannot answer in time; every "
        "learned response must then be measured again.",
        default=5.0,
        ge=1,
        le=100,
    )
    speed: Name = key("Channel of the line speed (_m_s).", default="line_speed_m_s")
    speed_reference: Name | None = key(
        "Channel of the set point of the line speed (_m_s), behind its ramp. For the record "
        "alone: `sim-plant refine` runs its line under it. Absent: the measured speed stands in.",
        default=None,
    )
    speed_max_m_s: MetresPerSecond | None = key(
        "Highest speed of normal operation; check counts samples per turn with it. Absent: the "
        "plausible maximum of the line speed.",
        default=None,
        gt=0,
        le=50,
    )


class Site(Section):
    """One line with its gateway, rolls, actuators and limits; every number in its key's unit."""

    version: Annotated[Literal[1], Whole("format")] = key("Version of the file format.")
    line: Line = key("The line as a whole.")
    gateway: Gateway = key("The connection to the PLC and the register map.")
    permissives: Permissives = key("Status bits without which no correction goes out.")
    freshness: Freshness = key("How old PLC data may become.", default_factory=Freshness)
    plausibility: Annotated[Mapping[Name, PlausibleRange], *Few] = key(
        "Believable range per channel. The line speed and every error signal need one."
    )
    rolls: Annotated[Mapping[Name, Roll], *Few] = key("The bodies whose turning makes ripple.")
    actuators: Annotated[Mapping[Name, Actuator], *Few] = key(
        "Where corrections go in; as many as gateway.write.corrections."
    )
    probe: Probe = key("The measurement of the loop response.", default_factory=Probe)
    recording: RecordingSettings = key(
        "The record of every run.", default_factory=RecordingSettings
    )

    @property
    def cycle_s(self) -> float:
        """Return the period of the control cycle, s."""
        return self.line.cycle_ms * 1e-3

    @property
    def recorded_only(self) -> frozenset[str]:
        """Return the channels that nothing but the record needs: no correction waits for them."""
        needed = {self.line.speed, *self.plausibility}
        for roll in self.rolls.values():
            needed |= {roll.angle or "", roll.speed or "", roll.line_speed or ""}
            needed.add(roll.radius or "")
        for actuator in self.actuators.values():
            needed |= {actuator.error.signal, actuator.error.reference or ""}
        return frozenset(self.gateway.read.channels) - needed

    @property
    def speed_max_m_s(self) -> float:
        """Return the highest line speed of normal operation, m/s."""
        return self.line.speed_max_m_s or self.plausibility[self.line.speed].high
