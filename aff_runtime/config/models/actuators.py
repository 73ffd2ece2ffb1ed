"""Section ``actuators``: where corrections go in, their limits and their harmonic blocks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from annotated_types import MaxLen
from pydantic import Field

from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.config.models.drive import Drive
from aff_runtime.config.quantity import (
    Few,
    Flag,
    Metres,
    MetresPerSecond,
    MetresPerSecond2,
    Name,
    NewtonMetres,
    NewtonMetresPerSecond,
    Newtons,
    Radians,
    Seconds,
    Section,
    Text,
    Turns,
    Whole,
    key,
)
from aff_runtime.core.laws.catalogue import LAW_ROWS

if TYPE_CHECKING:
    LawWord = str
else:
    LawWord = Literal[tuple(LAW_ROWS)]
Order = Annotated[int, Whole("periods per turn"), Field(ge=1, le=64)]


class ErrorSignal(Section):
    """What the actuator is to keep quiet."""

    signal: Name = key("Channel whose ripple is cancelled: a tension (_N) or a speed (_m_s).")
    reference: Name | None = key(
        "Channel of its set point, in the same unit. Absent: the slow mean of the signal.",
        default=None,
    )
    noise_N: Newtons | None = key(
        "Law shape, signal in N: how far one reading may be off, noise and what no order "
        "explains. Absent: 0.6. Raise it when shapes in status wander.",
        default=None,
        live=True,
        gt=0,
        le=1e4,
    )
    noise_m_s: MetresPerSecond | None = key(
        "The same for a signal in m/s. Absent: 0.0002.", default=None, live=True, gt=0, le=1
    )


class Start(Section):
    """What is known of one order of a roll: arm = R + deviation_m cos(order angle + angle_rad).

    The angle is the roll's angle channel as the PLC shows it. `sim-plant refine` writes these.
    """

    order: Order = key("Periods per turn; one of the block's orders.")
    deviation_m: Metres = key("Amplitude of the moment arm, such as 0.4 mm.", ge=0, le=0.1)
    angle_rad: Radians = key("Phase where the roll's angle is zero.", ge=-1000, le=1000)


class Block(Section):
    """Harmonic blocks of one roll on one actuator."""

    roll: Name = key("Roll whose angle drives the blocks.")
    orders: Annotated[tuple[Order, ...], *Few] = key(
        "Harmonics to cancel, periods per turn (1..64). Add one at a time; take one out that "
        "status shows as held. The plain law needs 20 samples per period of the highest.",
        live=True,
    )
    settle_s: Seconds = key(
        "Time in which the ripple settles. Start at 60; shorten until it stops improving, then "
        "double it. Too short amplifies noise and hunts.",
        live=True,
        ge=1,
        le=300,
    )
    amp_limit_m_s: MetresPerSecond | None = key(
        "Largest amplitude of each order, for velocity_reference. Raise it when BLOCK_CLAMPED "
        "shows and the cause is known.",
        default=None,
        live=True,
        gt=0,
        le=1,
    )
    amp_limit_N_m: NewtonMetres | None = key(
        "Largest amplitude of each order, for torque_reference.",
        default=None,
        live=True,
        gt=0,
        le=10000,
    )
    start: Annotated[tuple[Start, ...], MaxLen(64)] = key(
        "Law shape: deviations to start from, such as those of a refinement; a shape that was "
        "learned since goes before them. Needs the roll's angle channel.",
        default=(),
    )
    enabled: Flag = key(
        "false: these blocks fade out and stop learning, the rest goes on.",
        default=True,
        live=True,
    )

    @property
    def amp_limit(self) -> float:
        """Return the amplitude limit in the actuator's SI unit, 0 when none is given."""
        return self.amp_limit_m_s or self.amp_limit_N_m or 0.0


class Actuator(Section):
    """One drive whose reference takes a correction."""

    output: Literal["velocity_reference", "torque_reference"] = key(
        "Which reference of the drive takes the correction. It must go in after the ramp "
        "generator: a ramp bends a sine."
    )
    error: ErrorSignal = key("What is to be kept quiet.")
    law: LawWord = key(
        " ".join(f"{word}: {row.text}" for word, row in LAW_ROWS.items()), default="blocks"
    )
    memory_turns: Turns = key(
        "Law shape, the one number to tune: over how many turns of its roll an order is learned. "
        "Raise it when shapes in status wander, lower it for a roll that changes fast.",
        default=9.0,
        live=True,
        ge=1,
        le=100,
    )
    shape_limit_m: Metres = key(
        "Law shape: largest deviation of each order. Raise it when a block is CLAMPED here and "
        "the roll really is that far from round.",
        default=0.015,
        live=True,
        gt=0,
        le=0.1,
    )
    drive: Drive | None = key(
        "Law shape: the drive as its owner declares it. What is left open a probe identifies; "
        "until then the plain blocks stand in.",
        default=None,
    )
    limit_m_s: MetresPerSecond | None = key(
        "Largest correction in all, for velocity_reference. The PLC enforces the same or less.",
        default=None,
        live=True,
        gt=0,
        le=1,
    )
    limit_N_m: NewtonMetres | None = key(
        "Largest correction in all, for torque_reference. The PLC enforces the same or less.",
        default=None,
        live=True,
        gt=0,
        le=10000,
    )
    slew_m_s2: MetresPerSecond2 | None = key(
        "Fastest change of the correction, for velocity_reference. Lower it when the drive "
        "grows noisy; high orders then shrink.",
        default=None,
        live=True,
        gt=0,
        le=100,
    )
    slew_N_m_s: NewtonMetresPerSecond | None = key(
        "Fastest change of the correction, for torque_reference.",
        default=None,
        live=True,
        gt=0,
        le=1000000,
    )
    soft_start_s: Seconds = key(
        "Time in which the correction comes in after arming. Lengthen it when arming is felt in "
        "the web.",
        default=1.5,
        live=True,
        ge=0.1,
        le=30,
    )
    active_above_m_s: MetresPerSecond = key(
        "Line speed below which the correction fades and learning holds. Raise it when the "
        "start or stop of the line disturbs what was learned.",
        default=0.1,
        live=True,
        ge=0.01,
        le=50,
    )
    response: Text = key(
        "File of the measured loop response, below the folder of the site file or the state "
        "folder of the service; `aff-runtime probe` writes it. Without it nothing arms."
    )
    response_memory_s: Seconds = key(
        "Law shape: how long the loop remembers a correction. Lengthen it where no tension loop "
        "acts and the web renews itself slowly (length over speed, times three).",
        default=4.0,
        ge=0.5,
        le=20,
    )
    blocks: Annotated[tuple[Block, ...], *Few] = key(
        "Which rolls and orders to cancel. A whole block may come or go while a correction is "
        "active."
    )

    @property
    def uses_shape(self) -> bool:
        """Return whether the shape law runs; without a whole drive the plain blocks stand in."""
        return self.law == "shape" and self.drive is not None and self.drive.is_whole

    @property
    def stands_in(self) -> bool:
        """Return whether the plain blocks run in the place of law shape, which lacks a drive."""
        return self.law == "shape" and not self.uses_shape

    @property
    def law_that_runs(self) -> str:
        """Return the law's word; of the shape law without a drive, that of what stands in."""
        return "blocks" if self.stands_in else self.law

    @property
    def limit(self) -> float:
        """Return the total limit in the actuator's SI unit, 0 when none is given."""
        return self.limit_m_s or self.limit_N_m or 0.0

    @property
    def slew(self) -> float:
        """Return the slew limit in the actuator's SI unit per second, 0 when none is given."""
        return self.slew_m_s2 or self.slew_N_m_s or 0.0

    @property
    def unit(self) -> str:
        """Return the SI unit of the correction: ``m/s`` or ``N m``."""
        return "m/s" if self.output == "velocity_reference" else "N m"

    @property
    def response_unit(self) -> str:
        """Return the unit of the response: of the signal per unit of the correction."""
        return f"{unit_of_channel(self.error.signal) or '1'}/({self.unit})"
