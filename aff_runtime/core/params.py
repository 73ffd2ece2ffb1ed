"""Settings of the law in SI: what the site file says, as frozen records."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field
from enum import StrEnum

GRAVITY_M_S2 = 9.80665
IMBALANCE_N_M_PER_M = 100.0
"""Torque of an imbalance that counts as one metre of a shape."""


class OutputKind(StrEnum):
    """What the actuator's correction adds to."""

    VELOCITY_REFERENCE = "velocity_reference"
    TORQUE_REFERENCE = "torque_reference"


@dataclass(frozen=True, slots=True, kw_only=True)
class RollParams:
    """Where the angle of one roll comes from; channels are names in the site's channel table.

    Attributes
    ----------
    angle : encoder channel, rad; preferred source.
    angle_modulus_rad : the channel wraps by this much (2^32 counts in rad); None never wraps.
    angle_counts : counts in ``angle_modulus_rad``; 0: not known, or none.
    speed : roll speed channel, integrated when there is no encoder.
    speed_is_surface : True when ``speed`` is m/s at the surface, False when it is rad/s.
    line_speed : line speed channel, m/s, over the radius: the last resort.
    radius : radius channel, m (a roll that shrinks or grows); None for ``radius_m``.
    radius_m : fixed radius, m.
    radius_min_m, radius_max_m : a measured radius outside is ignored.
    resets_on_splice : a new roll id makes what was learned on this roll meaningless.
    max_omega_rad_s, max_acceleration_rad_s2 : an angle that moves faster is a glitch.
    moves_above_m_s : below this surface speed the roll stands, whatever a speed channel reads, and
        no law that knows the roll sends anything.
    """

    name: str
    angle: str | None = None
    angle_modulus_rad: float | None = None
    angle_counts: int = 0
    speed: str | None = None
    speed_is_surface: bool = True
    line_speed: str | None = None
    radius: str | None = None
    radius_m: float | None = None
    radius_min_m: float = 0.02
    radius_max_m: float = 2.0
    resets_on_splice: bool = False
    max_omega_rad_s: float = 200.0
    max_acceleration_rad_s2: float = 50.0
    moves_above_m_s: float = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockParams:
    """Harmonic blocks of one roll on one actuator.

    ``settle_s`` is the time in which a block reduces its order to 2 %; ``amp_limit`` bounds each
    block in the actuator's unit (m/s or N m).
    """

    roll: str
    orders: tuple[int, ...]
    settle_s: float
    amp_limit: float


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveParams:
    """The inner speed loop of one actuator and the roll it turns, as its owner declares them.

    Attributes
    ----------
    roll : the roll this drive turns; its radius channel gives the present radius.
    K_ref_rad_s, zeta : torque = J K (e + K/(4 zeta^2) integral e)   [source 2.24].
    inertia_kg_m2 : everything that turns except wound web.
    web_density_kg_m3, web_width_m, core_radius_m : wound web on top; density 0 for a roller.
    tension_N : used where the actuator has no reference channel.
    torque_term : the tension pulls through the varying arm (a roll whose own shape is learned).
    imbalance : learn a gravity torque of the roll beside its shape.
    web_leaves_rad : where the web leaves the roll, counted from its highest point in the sense of
        rotation; NaN when not known.
    """

    roll: str
    K_ref_rad_s: float
    zeta: float
    inertia_kg_m2: float
    web_density_kg_m3: float = 0.0
    web_width_m: float = 0.0
    core_radius_m: float = 0.0
    tension_N: float = 0.0
    torque_term: bool = True
    imbalance: bool = True
    web_leaves_rad: float = math.nan

    @property
    def corner_rad_s(self) -> float:
        """Corner K/(4 zeta^2) of the speed loop's integral, rad/s."""
        return self.K_ref_rad_s / (4.0 * self.zeta**2)

    def inertia_at(self, radius_m: float) -> float:
        """Return the inertia at a roll radius, kg m2   [source 2.4]."""
        wound = radius_m**4 - self.core_radius_m**4
        share = 0.5 * math.pi * self.web_density_kg_m3 * self.web_width_m
        return self.inertia_kg_m2 + share * max(0.0, wound)

    def weight_of_shape_N(self, radius_m: float) -> complex:
        """Return the gravity torque per metre of order 1 of the wound web's shape, N, as a phasor.

        What sticks out is heavy: a centre of gravity e from the axis gives the torque
        -j m g e e^{j l}, a phasor that counts from where the web leaves; l is the angle of that
        place from the roll's highest point in the sense of rotation. 0 where l is not declared.
        """
        if math.isnan(self.web_leaves_rad):
            return 0j
        area_m2 = math.pi * max(0.0, radius_m**2 - self.core_radius_m**2)
        mass_kg = self.web_density_kg_m3 * self.web_width_m * area_m2
        return -1j * mass_kg * GRAVITY_M_S2 * cmath.rect(1.0, self.web_leaves_rad)


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeParams:
    """Settings of the shape law; the operator's one number is ``memory_turns``.

    ``signal_sd`` is how far one reading may be off (noise and what no order explains), in the
    signal's unit; ``weight_limit_m`` bounds every weight; ``response_s`` is how long P remembers.
    """

    memory_turns: float = 9.0
    signal_sd: float = 0.6
    weight_limit_m: float = 0.015
    response_s: float = 4.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuatorParams:
    """One correction output and the blocks that make it.

    Attributes
    ----------
    signal, reference : channels of the error y_ref - y; without reference the slow mean of the
        signal stands in for it.
    active_above_m_s : below this speed the output fades out and nothing adapts.
    transport_s : time a command needs to act beyond half a cycle; the carrier leads by both.
    speed_scaled : weights in metres that multiply the roll's speed; None: on for velocity outputs.
    mean_tau_s : time constant of the mean that is taken out of the error.
    law : key of ``core.laws.catalogue.LAWS``.
    drive, shape : of the shape law; without a drive the plain blocks stand in.
    stands_in : ``law`` runs because law shape, which is wanted, waits for a drive.
    turns : roll that the drive turns, where ``drive`` does not say it; "": the first block's.
    """

    name: str
    signal: str
    reference: str | None = None
    output: OutputKind = OutputKind.VELOCITY_REFERENCE
    active_above_m_s: float = 0.1
    transport_s: float = 0.0
    speed_scaled: bool | None = None
    mean_tau_s: float = 10.0
    law: str = "blocks"
    stands_in: bool = False
    drive: DriveParams | None = None
    shape: ShapeParams = field(default_factory=ShapeParams)
    blocks: tuple[BlockParams, ...] = ()
    turns: str = ""

    @property
    def turned_roll(self) -> str:
        """Name of the roll that the drive turns; empty when none is named."""
        if self.drive is not None:
            return self.drive.roll
        return self.turns or next((block.roll for block in self.blocks), "")

    @property
    def scales_with_speed(self) -> bool:
        """Whether weights multiply the roll's speed."""
        if self.speed_scaled is None:
            return self.output is OutputKind.VELOCITY_REFERENCE
        return self.speed_scaled

    @property
    def unit(self) -> str:
        """Unit of the output as a name suffix."""
        return "m_s" if self.output is OutputKind.VELOCITY_REFERENCE else "N_m"

    @property
    def orders(self) -> tuple[tuple[str, int], ...]:
        """Every (roll, order) of this actuator, in the order of the site file."""
        return tuple((b.roll, n) for b in self.blocks for n in b.orders)


@dataclass(frozen=True, slots=True, kw_only=True)
class SiteParams:
    """What the law needs of the site; ``channels`` is the order of the snapshot's values."""

    cycle_s: float
    channels: tuple[str, ...]
    rolls: tuple[RollParams, ...]
    actuators: tuple[ActuatorParams, ...]
    line_speed: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeParams:
    """How the response is measured.

    ``amplitude`` bounds the whole excitation of each actuator in its unit. With ``is_chosen`` it
    is the most that may be sent: what is sent follows from the noise, but is no less than
    ``louder_than``. A signal in newtons may move by ``bound_N``, or by ``bound_share`` of its mean
    where that is less, else the probe ends. Tones stand
    ``offset_Hz`` beside every configured order, on a log grid of ``grid_points`` over the band
    that the orders sweep (to the smallest radius at ``max_speed_m_s``, up to ``f_max_Hz``), on
    ``low_points`` below it and at ``extra_frequencies_Hz``; above ``louder_from_Hz`` they grow
    with frequency. ``duration_s``
    counts fades of ``fade_s`` and a wait of ``settle_s`` for transients; ``listen_s`` comes
    before.
    """

    actuators: tuple[str, ...]
    amplitude: float
    f_max_Hz: float
    louder_from_Hz: float
    duration_s: float = 25.0
    offset_Hz: float = 0.15
    extra_frequencies_Hz: tuple[float, ...] = field(default=())
    grid_points: int = 12
    low_points: int = 0
    max_speed_m_s: float = 0.0
    fade_s: float = 1.0
    settle_s: float = 3.0
    listen_s: float = 2.0
    nuisance_orders: int = 8
    is_chosen: bool = False
    louder_than: float = 0.0
    bound_N: float = math.inf
    bound_share: float = math.inf

    @property
    def measured_s(self) -> float:
        """How much of the record is fitted."""
        return self.duration_s - 2.0 * self.fade_s - self.settle_s
