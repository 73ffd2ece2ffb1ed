"""Messages of the supervisor to the cycle; taken between two ticks, in order."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from aff_runtime.base.ports import Law


@dataclass(frozen=True, slots=True, kw_only=True)
class Arm:
    """An operator wants the correction on the line."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bypass:
    """An operator wants the correction off, now."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shadow:
    """Compute and record without transmitting, or end that."""

    on: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Stop:
    """Fade to zero and return."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SupervisorLost:
    """The other end of the command link is gone: latch, fade to zero and return."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Swap:
    """Go on with other settings from the next tick.

    Attributes
    ----------
    law : the new law; None keeps the present one.
    take_over : called with the old law before the new one's first step, so that the output does
        not jump; None uses the new law's own ``take_over``; without either, the output fades to
        zero, the laws change places, and it comes back softly.
    guard_params : new settings for ``Guard.adopt``; None keeps the present ones.
    config_revision : shown to the PLC from now on; None keeps it.
    """

    law: Law | None = None
    take_over: Callable[[Law], object] | None = None
    guard_params: object | None = None
    config_revision: int | None = None


Message = Arm | Bypass | Shadow | Stop | SupervisorLost | Swap
