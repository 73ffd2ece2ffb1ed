"""The state word AFF -> PLC."""

from __future__ import annotations

from aff_runtime.base.signals import State, StateBits
from aff_runtime.safety.state_machine import Standing

_READY = int(StateBits.READY)  # plain numbers: `|` of a flag costs 2 us
_OF_STATE = {
    State.FAULT: int(StateBits.FAULT),
    State.OFF: 0,
    State.READY: _READY,
    State.ARMED: _READY,
    State.ACTIVE: _READY | int(StateBits.ACTIVE),
    State.FADING: _READY,
    State.BYPASS: int(StateBits.BYPASS),
    State.SHADOW: 0,
}
_ACTIVE = State.ACTIVE
_ARMED, _FADING = int(StateBits.ARMED), int(StateBits.FADING)
_SATURATED, _COMM_WARN = int(StateBits.SATURATED), int(StateBits.COMM_WARN)


def state_word(standing: Standing, *, zeros_sent: bool, saturated: bool, comm_warn: bool) -> int:
    """Return the bits of ``StateBits``.

    FADING is set in any closed state until zeros have been sent: without the bit the PLC takes no
    correction, zero included, and would ramp down from the last one that was not zero.
    """
    bits = _OF_STATE[standing.state]
    if standing.armed:
        bits |= _ARMED
    if standing.state is not _ACTIVE and not zeros_sent:
        bits |= _FADING
    if saturated:
        bits |= _SATURATED
    if comm_warn:
        bits |= _COMM_WARN
    return bits
