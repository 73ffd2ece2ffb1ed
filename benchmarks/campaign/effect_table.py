"""What the campaign knows of every effect: one row each, and the only place that names one."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from benchmarks.campaign import beyond, effects
from benchmarks.campaign.beyond import Coordinate, Draw
from benchmarks.campaign.effects import CELLS, DRIVES, IDLERS, Fault
from benchmarks.campaign.motion import TICK_S
from benchmarks.campaign.state import Machine

ROLLERS = (*IDLERS, "swrap", "pull_roll")


def once(_shape: float) -> float:
    """Return the order of what shows once a turn."""
    return 1.0


def as_told(shape: float) -> float:
    """Return the order of what shows as often a turn as its fault says."""
    return shape


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One effect of the library, or something beyond it.

    Attributes
    ----------
    name : in a verdict, or of something no library has.
    change : puts a fault on the machine; None: a verdict may name it, no case has it.
    drawn_at, first_size, shapes, either_sign : places, size to begin with and further numbers to
        draw from; without a place it is not drawn as an effect of the library.
    often, beside_others, in_ablations, taken_out : drawn twice as often alone; drawn as a second
        or third effect; drawn for a poor record; taken out of the library in some cases.
    outside : draws something beyond any library; None: the library has it.
    line : where it makes lines of its own: at orders of its body, or in time.
    order : (shape of the fault) -> order of its body, of what has one line or a first one.
    coordinate : (fault as a mapping) -> where its free line is; None: at ``order``.
    alike : effects of one word may answer alike: at the same line, or standing.
    rival_at, rival_shapes : where and with which further numbers it is such a rival.
    largest : size beyond which nobody would ask why, of what tolerances may hide.
    standing : without a line of its own: a declared number within its tolerance may hide it.
    proportional : the response grows with the size, so one run tells the size that is wanted.
    step : its size is a multiple of this.
    strength : parameter of a verdict that says its size, and what size 0 is there.
    said_as : its name in a version 1 verdict.
    cell_zero : a wrong zero of a load cell is read as this.
    """

    name: str
    change: Callable[[Machine, Fault], Machine] | None = None
    drawn_at: tuple[str, ...] = ()
    first_size: float = 0.0
    shapes: tuple[float, ...] = (0.0,)
    either_sign: bool = False
    often: bool = False
    beside_others: bool = False
    in_ablations: bool = False
    taken_out: bool = False
    outside: Draw | None = None
    line: Literal["", "turn", "time"] = ""
    order: Callable[[float], float] = once
    coordinate: Coordinate | None = None
    alike: Literal["", "one line", "standing"] = ""
    rival_at: tuple[str, ...] = ()
    rival_shapes: tuple[float, ...] = (0.0,)
    largest: float = math.inf
    standing: bool = False
    proportional: bool = False
    step: float = 0.0
    strength: tuple[str, float] = ("", 0.0)
    said_as: str = ""
    cell_zero: bool = False


EFFECTS = (
    Row(
        name="eccentric_roller",
        change=effects.eccentric,
        drawn_at=ROLLERS,
        first_size=2e-5,
        often=True,
        beside_others=True,
        in_ablations=True,
        taken_out=True,
        line="turn",
        alike="one line",
        rival_at=ROLLERS,
        proportional=True,
        strength=("eccentricity_m", 0.0),
    ),
    Row(
        name="out_of_round_roll",
        change=effects.out_of_round,
        drawn_at=("unwind", "unwind", "rewind"),
        first_size=1e-4,
        shapes=(1.0, 2.0, 3.0, 0.0),
        often=True,
        beside_others=True,
        in_ablations=True,
        taken_out=True,
        line="turn",
        order=lambda shape: max(1.0, shape),
    ),
    Row(
        name="unbalanced_roller",
        change=effects.unbalanced,
        drawn_at=("R1", "R3", "swrap", "pull_roll"),
        first_size=5e-3,
        beside_others=True,
        in_ablations=True,
        line="turn",
        alike="one line",
        rival_at=ROLLERS,
        proportional=True,
        strength=("unbalance_kg_m", 0.0),
    ),
    Row(
        name="unbalanced_measuring_roller",
        change=effects.unbalanced_cell,
        drawn_at=tuple(CELLS),
        first_size=3e-4,
        line="turn",
        alike="one line",
        rival_at=tuple(CELLS),
        proportional=True,
        strength=("unbalance_kg_m", 0.0),
        said_as="unbalanced_roller",
    ),
    Row(
        name="torque_ripple",
        change=effects.ripple,
        drawn_at=tuple(DRIVES),
        first_size=0.1,
        shapes=(2.0, 3.0, 4.0, 5.0, 6.0, 8.0),
        often=True,
        beside_others=True,
        in_ablations=True,
        taken_out=True,
        line="turn",
        order=as_told,
        alike="one line",
        rival_at=tuple(DRIVES),
        rival_shapes=(2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 1.0),
        proportional=True,
        strength=("amplitude_N_m", 0.0),
    ),
    Row(
        name="bearing_drag",
        change=effects.drag,
        drawn_at=tuple(IDLERS),
        first_size=0.01,
        alike="standing",
        rival_at=tuple(IDLERS),
        largest=0.2,
        standing=True,
        proportional=True,
        strength=("constant_N_m", 0.0),
    ),
    Row(
        name="web_modulus",
        change=effects.modulus,
        drawn_at=("web",),
        first_size=0.1,
        either_sign=True,
        largest=0.5,
        standing=True,
        strength=("factor", 1.0),
    ),
    Row(
        name="wound_in_strain",
        change=effects.wound_in,
        drawn_at=("unwind",),
        first_size=1e-3,
        either_sign=True,
        largest=5e-3,
        standing=True,
        proportional=True,
        strength=("strain", 0.0),
    ),
    Row(
        name="thermal_strain",
        change=effects.thermal,
        drawn_at=("pull_roll_zone",),
        first_size=5e-5,
        alike="standing",
        rival_at=("pull_roll_zone",),
        largest=2e-3,
        standing=True,
        proportional=True,
        strength=("strain", 0.0),
    ),
    Row(
        name="slip",
        change=effects.slip,
        drawn_at=("swrap", "pull_roll"),
        first_size=2e-4,
        shapes=(0.8, 1.0),
        largest=5e-3,
        standing=True,
        strength=("slope_s_m", 0.0),
    ),
    Row(
        name="load_cell_filter",
        change=effects.slow_cell,
        drawn_at=("R2", "R7", "all"),
        first_size=0.03,
        largest=0.2,
        standing=True,
        strength=("lag_s", 0.0),
    ),
    Row(
        name="mains_hum",
        change=effects.hum,
        drawn_at=tuple(CELLS),
        first_size=0.2,
        shapes=(60.0, 120.0),
        beside_others=True,
        taken_out=True,
        line="time",
        coordinate=beyond.alias,
        proportional=True,
        strength=("amplitude_N", 0.0),
    ),
    Row(
        name="loop_delay",
        change=effects.delay,
        drawn_at=("unwind", "rewind"),
        first_size=0.03,
        largest=0.2,
        standing=True,
        step=TICK_S,
        strength=("delay_s", 0.0),
    ),
    Row(
        name="encoder_eccentricity",
        change=effects.encoder,
        drawn_at=tuple(DRIVES),
        first_size=2e-4,
        shapes=(0.0, 1.0),
        beside_others=True,
        line="turn",
        alike="one line",
        rival_at=tuple(DRIVES),
        rival_shapes=(0.0, 1.0),
        proportional=True,
        strength=("eccentricity", 0.0),
    ),
    Row(name="radius_error", change=effects.believed_radius),
    Row(name="roll_bounce", line="turn"),
    Row(name="load_cell_calibration", cell_zero=True),
    # beyond any library
    Row(
        name="dancer_swing",
        change=effects.shaken,
        outside=beyond.swing,
        coordinate=beyond.as_drawn,
        proportional=True,
    ),
    Row(
        name="hidden_nip",
        change=effects.shaken,
        outside=beyond.nip,
        coordinate=beyond.as_drawn,
        proportional=True,
    ),
    Row(
        name="web_wave",
        change=effects.web_wave,
        outside=beyond.wave,
        coordinate=beyond.under_tension,
        proportional=True,
    ),
    Row(name="stiffening_web", change=effects.stiffening, outside=beyond.stiffer, standing=True),
    Row(
        name="gusty_drive",
        change=effects.gusty_drive,
        outside=beyond.gusts,
        standing=True,
        proportional=True,
    ),
    Row(
        name="drifting_cell",
        change=effects.drifting_cell,
        outside=beyond.drift,
        standing=True,
        proportional=True,
    ),
)
BY_NAME = {row.name: row for row in EFFECTS}
