"""The declaration of a line, as its owner documents it: schema web-line-declaration/1.

SI with units in the key names; angles in degrees where the key says so. ``tolerances`` and
``origins`` map a dotted path (``web.EA_N``, ``rollers.R6.inertia_kg_m2``, wildcards allowed) to a
relative tolerance and to where the number comes from. ``corrections`` maps such a
path to what measured data add to the number (relative; offsets in N, the pull-roll draw as the
ratio itself; a true radius leaves what the drive divides by as declared). ``effects`` lists what
is known to be wrong with the line. The nominal line is the one without them.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from sim_plant.line.declared.declared_bodies import Accumulator, Dancer, HeatedSpan, PositionPi
from sim_plant.line.declared.sections import Finite, Name, NotNegative, Positive, Section, Tick


class Web(Section):
    """The material."""

    EA_N: Positive = Field(description="Young's modulus times cross section")
    density_kg_m3: Positive
    thickness_m: Positive
    width_m: Positive
    kelvin_voigt_eta_s: NotNegative = 0.0
    tension_law: str = "T = EA*(strain + eta*dstrain/dt), never below 0"
    wound_in_tension_N: NotNegative = Field(description="tension at which the roll was wound")
    thermal_expansion_1_K: Finite = 0.0
    room_exchange_s: Positive = Field(
        default=60.0, description="time constant with which the web takes the room's temperature"
    )


class InitialRadii(Section):
    """Roll radii at the start."""

    unwind: Positive
    rewind: Positive
    core: Positive


class Roller(Section):
    """One body that the web wraps, in web order."""

    name: Name
    kind: Literal["roll", "idler", "driven"]
    radius_m: Positive
    inertia_kg_m2: Positive
    friction_constant_N_m: NotNegative
    friction_viscous_N_m_s: NotNegative
    rotation: Literal["ccw", "cw"]
    wrap_angle_deg: Finite | None = None
    center_x_m: Finite
    center_y_m: Finite


class SpanEntry(Section):
    """One free span, tangent point to tangent point."""

    start: Name
    end: Name
    length_m: Positive
    direction_deg: Finite


class CoreInertia(Section):
    """Inertia of rolls without web."""

    unwind_core_and_drive: Positive
    rewind_core_and_drive: Positive


class Drive(Section):
    """Inner speed PI of one driven body."""

    roller: Name
    K_ref_rad_s: Positive
    zeta: Positive
    speed_reference: str
    inertia_used: str


class TensionPi(Section):
    """Outer tension loop."""

    loop: Name
    acts_on: Name
    load_cell: Name
    gain_m_s_per_N: Positive
    corner_rad_s: Positive
    law: str


class Control(Section):
    """All loops."""

    drives: tuple[Drive, ...]
    drive_law: str
    drive_sample_time_s: Tick
    drive_torque_limit_N_m: Positive
    pull_roll_draw: Finite = 0.0
    tension_pi: tuple[TensionPi, ...]
    position_pi: tuple[PositionPi, ...] = ()
    tension_loop_sample_time_s: Positive


class LoadCell(Section):
    """Tension at a roller, through the cell's low-pass."""

    kind: Literal["load_cell"] = "load_cell"
    channel: Name
    roller: Name
    low_pass_Hz: Positive
    low_pass_order: Literal[1] | None = None
    noise_sd_N: NotNegative | None = None
    lsb_N: NotNegative | None = None


class DriveSpeed(Section):
    """Speed of a driven roller; in m/s where ``scale_radius_m`` says at which radius."""

    kind: Literal["drive_speed"] = "drive_speed"
    channel: Name
    roller: Name
    noise_sd_rad_s: NotNegative | None = None
    lsb_rad_s: NotNegative | None = None
    scale_radius_m: Positive | None = None


class RollAngle(Section):
    """Angle of a roll or roller from its encoder; it counts from zero at the start."""

    kind: Literal["roll_angle"] = "roll_angle"
    channel: Name
    roller: Name
    lsb_rad: NotNegative
    zero: str | None = None


class RollRadius(Section):
    """Radius of an unwinding or rewinding roll."""

    kind: Literal["roll_radius"] = "roll_radius"
    channel: Name
    roller: Name
    lsb_m: NotNegative


class CarriagePosition(Section):
    """Travel of the dancer or accumulator that a roller belongs to; 0 where the file puts it."""

    kind: Literal["carriage_position"] = "carriage_position"
    channel: Name
    roller: Name
    lsb_m: NotNegative


def _kind_of(given: Any) -> str:
    """Return a sensor's kind, from its own keys where it does not say."""
    if not isinstance(given, dict):
        return str(getattr(given, "kind", ""))
    if "kind" in given:
        return str(given["kind"])
    told_by = {"low_pass_Hz": "load_cell", "lsb_m": "roll_radius", "lsb_rad": "roll_angle"}
    return next((kind for key, kind in told_by.items() if key in given), "drive_speed")


Sensor = Annotated[
    Annotated[LoadCell, Tag("load_cell")]
    | Annotated[DriveSpeed, Tag("drive_speed")]
    | Annotated[RollAngle, Tag("roll_angle")]
    | Annotated[RollRadius, Tag("roll_radius")]
    | Annotated[CarriagePosition, Tag("carriage_position")],
    Discriminator(_kind_of),
]


class EffectEntry(Section):
    """An effect that the line is known to have."""

    effect: Name
    location: Name
    parameters: dict[str, Any] = Field(default_factory=dict)


class OperatingPoint(Section):
    """Where the line runs when nobody says otherwise."""

    line_speed_m_s: Finite = 1.016
    tension_N: Positive = 88.9644


class Declaration(Section):
    """A whole line."""

    schema_: Literal["web-line-declaration/1"] = Field(alias="schema")
    sample_time_s: Tick
    samples: int | None = None
    note: str = ""
    units: str = ""
    web: Web
    initial_radii_m: InitialRadii
    rollers: tuple[Roller, ...] = Field(min_length=3)
    spans: tuple[SpanEntry, ...]
    geometry_note: str = ""
    friction_law: str = ""
    inertia_kg_m2: CoreInertia
    dancers: tuple[Dancer, ...] = ()
    accumulators: tuple[Accumulator, ...] = ()
    heated_spans: tuple[HeatedSpan, ...] = ()
    control: Control
    sensors: tuple[Sensor, ...]
    sensor_note: str = ""
    reference_columns: tuple[Name, ...] = ()
    operating_point: OperatingPoint = OperatingPoint()
    tolerances: dict[str, NotNegative] = Field(default_factory=dict)
    origins: dict[str, str] = Field(default_factory=dict)
    corrections: dict[str, float] = Field(default_factory=dict)
    effects: tuple[EffectEntry, ...] = ()
    provenance: dict[str, Any] = Field(default_factory=dict)

    @property
    def carriages(self) -> tuple[Dancer | Accumulator, ...]:
        """Everything that moves rollers: dancers, then accumulators."""
        return (*self.dancers, *self.accumulators)

    def carriage(self, name: str) -> int:
        """Return the index of carriage ``name``; KeyError when there is none."""
        for index, carriage in enumerate(self.carriages):
            if carriage.name == name:
                return index
        raise KeyError(name)

    def carriage_of(self, roller: str) -> int:
        """Return the index of the carriage that ``roller`` belongs to, or -1: it stands."""
        for index, carriage in enumerate(self.carriages):
            if roller in carriage.rollers:
                return index
        return -1

    def body(self, name: str) -> int:
        """Return the index of roller ``name``; KeyError when there is none."""
        for index, roller in enumerate(self.rollers):
            if roller.name == name:
                return index
        raise KeyError(name)
