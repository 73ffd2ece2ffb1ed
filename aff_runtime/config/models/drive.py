"""Section ``drive`` of an actuator: the speed loop and the roll it turns, as declared."""

from __future__ import annotations

from aff_runtime.config.quantity import (
    Flag,
    KilogramMetres2,
    KilogramsPerMetre3,
    Metres,
    Milliseconds,
    Name,
    Newtons,
    Radians,
    RadiansPerSecond,
    Ratio,
    Seconds,
    Section,
    key,
)
from aff_runtime.core.bandwidth import Band, band_of

SLOW_GAIN_RAD_S = 15.0
"""Of a speed loop that nobody has said anything of: the first probe asks for no more than what
such a one carries, the next one for what the first has found."""


def slow_band(cycle_s: float) -> Band:
    """Return the frequencies to probe where nothing is known of the drive."""
    return band_of(SLOW_GAIN_RAD_S, SLOW_GAIN_RAD_S / 4.0, cycle_s)


class Drive(Section):
    """The drive that law shape turns round: torque = inertia * gain * (e + integral of e / Ti).

    What is left open (gain, damping, inertia, transport) a probe identifies; what is declared
    wins. The law needs these to 10 or 20 %: what is wrong with them it learns as a correction per
    order. Numbers are those seen at the roll; a motor behind a gear is added with gear_ratio.
    """

    roll: Name = key("Roll that this drive turns; one of the actuator's blocks is on it.")
    speed_gain_rad_s: RadiansPerSecond | None = key(
        "Proportional gain of the speed loop over the inertia: its bandwidth. Half or twice the "
        "true one costs nothing to speak of; a thousandth makes ripple instead of taking it away. "
        "Absent: as a probe identifies it.",
        default=None,
        ge=0.5,
        le=1000,
    )
    zeta: Ratio | None = key(
        "Damping of the speed loop; its integral time is 4 zeta^2 / speed_gain_rad_s. Give this "
        "or integral_time_s; absent with the gain: as a probe identifies it.",
        default=None,
        gt=0.1,
        le=20,
    )
    integral_time_s: Seconds | None = key(
        "Integral (reset) time of the speed loop.", default=None, gt=0.001, le=100
    )
    inertia_kg_m2: KilogramMetres2 | None = key(
        "Inertia at the roll: core, chuck, coupling; wound web is counted from web_density_kg_m3. "
        "Absent: as a probe identifies it, less what is declared of the web.",
        default=None,
        gt=0,
        le=1e5,
    )
    motor_inertia_kg_m2: KilogramMetres2 = key(
        "Inertia of the motor at its own shaft.", default=0.0, ge=0, le=1e4
    )
    gear_ratio: Ratio = key(
        "Turns of the motor in one turn of the roll.", default=1.0, gt=0, le=1e3
    )
    web_density_kg_m3: KilogramsPerMetre3 = key(
        "Density of the wound web; 0 for a roller.", default=0.0, ge=0, le=25000
    )
    web_width_m: Metres = key("Width of the wound web.", default=0.0, ge=0, le=20)
    core_radius_m: Metres = key(
        "Radius of the core that the web is wound on.", default=0.0, ge=0, le=2
    )
    tension_N: Newtons | None = key(
        "Usual tension at the roll; required where error has no reference.",
        default=None,
        gt=0,
        le=1e5,
    )
    tension_pulls: Flag = key(
        "true: the web's tension pulls on this roll through its varying arm, as on an unwind. "
        "false for a roller that is wrapped by the same tension on both sides.",
        default=True,
    )
    imbalance: Flag = key(
        "true: learn the weight that is out of centre beside the shape.", default=True
    )
    web_leaves_rad: Radians | None = key(
        "Where the web leaves the roll: angle past its highest point, counted the way it turns "
        "(90 deg: at the side that goes down, 180 deg: at the bottom). What sticks out of a roll "
        "is heavy, and this says when it pulls; the first change of speed then costs less.",
        default=None,
        ge=0,
        le=6.2832,
    )
    transport_ms: Milliseconds | None = key(
        "Time from a snapshot to its correction at the drive. Absent: three cycles, or as "
        "a probe identifies it with the rest. Matters for a change of speed alone.",
        default=None,
        ge=0,
        le=500,
    )

    @property
    def is_whole(self) -> bool:
        """Return whether nothing that the law needs is left open."""
        damped = self.zeta is not None or self.integral_time_s is not None
        return self.speed_gain_rad_s is not None and self.inertia_kg_m2 is not None and damped

    @property
    def damping(self) -> float:
        """Return zeta, from the integral time when that is given (Ti = 4 zeta^2 / gain)."""
        if self.zeta is not None:
            return self.zeta
        time_s = self.integral_time_s or 1.0
        return 0.5 * float(((self.speed_gain_rad_s or 0.0) * time_s) ** 0.5)

    def band(self, cycle_s: float) -> Band:
        """Return the frequencies that this drive and the cycle let an order have.

        A drive whose numbers are open counts as a slow one, until a probe has found them.
        """
        if self.speed_gain_rad_s is None:
            return slow_band(cycle_s)
        K_rad_s = self.speed_gain_rad_s
        return band_of(K_rad_s, K_rad_s / (4.0 * self.damping**2), cycle_s)

    @property
    def total_inertia_kg_m2(self) -> float:
        """Return everything that turns with the roll but its web, seen at the roll."""
        return (self.inertia_kg_m2 or 0.0) + self.motor_inertia_kg_m2 * self.gear_ratio**2
