r"""The guard's states: a pure function from (standing, inputs) to standing.

FAULT is where it starts. Only an operator's edge, with fresh data and the cause gone, leaves it.
OFF and READY differ by the permissives; ARMED waits for line speed; ACTIVE lets the correction
out; FADING takes it back. BYPASS and FAULT are one tick away from everywhere.

    FAULT --arm--> ARMED <--> ACTIVE --> FADING --> ARMED   (speed)
      ^     \                                  \--> OFF     (permissive, comes back by itself
    latch    --> OFF <--> READY --arm--> ARMED             while the request stands)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from aff_runtime.base.signals import LATCHED_STATES, State

_ACTIVE, _FADING, _SHADOW = State.ACTIVE, State.FADING, State.SHADOW


@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """Where the guard stands; ``armed``: the operator's request still holds."""

    state: State = State.FAULT
    armed: bool = False


class Inputs(NamedTuple):
    """What one tick brings.

    Attributes
    ----------
    arm_edge, bypass_edge : an operator asked since the last tick.
    shadow : shadow operation is wanted; ``shadow_edge``: since this tick.
    latching : a cause is present whose reaction is FADE_AND_LATCH.
    blocked : a permissive is missing or something else keeps the output closed without latching.
    moving : at least one output may open by line speed.
    quiet : every output is zero and closed.
    """

    arm_edge: bool
    bypass_edge: bool
    shadow: bool
    shadow_edge: bool
    latching: bool
    blocked: bool
    moving: bool
    quiet: bool


def advance(standing: Standing, inputs: Inputs) -> Standing:
    """Return the next standing; strongest reason first. Never raises."""
    if inputs.bypass_edge:
        return Standing(state=State.BYPASS)
    if standing.state in LATCHED_STATES:
        return _from_rest(standing, inputs)
    if inputs.latching or inputs.shadow:
        return Standing(state=State.FAULT if inputs.latching else State.SHADOW)
    if standing.state is _SHADOW:
        return _unarmed(inputs)
    if standing.state in (_ACTIVE, _FADING):
        return _from_live(standing, inputs)
    return _from_waiting(standing, inputs)


def _from_rest(standing: Standing, inputs: Inputs) -> Standing:
    """FAULT, BYPASS: only a deliberate edge leads out, and never past a present cause."""
    if inputs.latching or not inputs.quiet or not (inputs.arm_edge or inputs.shadow_edge):
        return standing
    if inputs.shadow:
        return Standing(state=State.SHADOW)
    return _unarmed(inputs) if inputs.blocked else _open(inputs)


def _from_live(standing: Standing, inputs: Inputs) -> Standing:
    """ACTIVE and FADING: what fades, fades to the end."""
    closing = inputs.blocked or not inputs.moving
    if standing.state is _ACTIVE:
        return Standing(state=State.FADING, armed=True) if closing else standing
    if not inputs.quiet:
        return standing
    return Standing(state=State.OFF, armed=True) if inputs.blocked else _open(inputs)


def _from_waiting(standing: Standing, inputs: Inputs) -> Standing:
    """OFF, READY, ARMED: the operator's request stands through a lost permissive."""
    if inputs.blocked:
        return Standing(state=State.OFF, armed=standing.armed)
    if not (standing.armed or inputs.arm_edge):
        return Standing(state=State.READY)
    return _open(inputs) if inputs.quiet else standing


def _open(inputs: Inputs) -> Standing:
    return Standing(state=State.ACTIVE if inputs.moving else State.ARMED, armed=True)


def _unarmed(inputs: Inputs) -> Standing:
    return Standing(state=State.OFF if inputs.blocked else State.READY)
