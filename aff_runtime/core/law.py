"""The port for laws of one actuator: what a law is built from, what it sees, what it answers."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

from aff_runtime.base.signals import ActuatorStep
from aff_runtime.core.impulse import LoopModel
from aff_runtime.core.params import ActuatorParams
from aff_runtime.core.phase import RollPhase
from aff_runtime.core.response import Response


@dataclass(slots=True)
class Inputs:
    """What one actuator's law sees in one tick; refilled, not rebuilt, from tick to tick.

    ``fresh`` False: a duplicate or missing sample. ``limit_ratio`` and ``applied_ratio`` are the
    guard's answer to this actuator's last output, ``limit`` and ``slew_limit`` the room that it
    has for the next one (see ``Permission``).
    """

    signal: float = math.nan
    reference: float = math.nan
    line_speed_m_s: float = math.nan
    dt_s: float = 0.0
    fresh: bool = False
    adapt: bool = False
    limit_ratio: float = 1.0
    applied_ratio: float = 0.0
    limit: float = math.inf
    slew_limit: float = math.inf


class ActuatorLaw(Protocol):
    """A law of one actuator. The phases of the rolls were advanced before ``step``."""

    def step(self, inputs: Inputs) -> ActuatorStep:
        """Advance by ``inputs.dt_s``; never raises, always finite."""
        ...

    def reset_roll(self, roll: str) -> None:
        """Forget what was learned on a roll."""
        ...

    def weights(self) -> Mapping[tuple[str, int], complex]:
        """Return what was learned, by (roll, order)."""
        ...

    def adopt(self, old: ActuatorLaw) -> None:
        """Go on where ``old`` stands, so that a change of settings makes no bump."""
        ...

    def objections(self) -> tuple[str, ...]:
        """Return why this actuator may not arm now; empty when it may."""
        ...

    def ripple(self) -> tuple[float, float]:
        """Return ripple of all orders before and now, in the signal's unit; NaN when unknown."""
        ...

    def telemetry(self) -> tuple[float, ...]:
        """Return numbers in the order of ``telemetry_names``."""
        ...

    def telemetry_names(self) -> tuple[str, ...]:
        """Return column names, without the actuator's."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class LawSetup:
    """What a law of one actuator is built from.

    Attributes
    ----------
    phases : angles of the rolls, by name.
    response : measured response of this actuator; None: nothing may be adapted.
    loop : its impulse response, where it is known already (to find it takes tenths of a second).
    """

    params: ActuatorParams
    phases: Mapping[str, RollPhase]
    response: Response | None
    loop: LoopModel | None
    cycle_s: float


LawBuilder = Callable[[LawSetup], ActuatorLaw]
