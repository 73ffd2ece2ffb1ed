"""The state word AFF -> PLC."""

from __future__ import annotations

from aff_runtime.base.signals import State, StateBits
from aff_runtime.safety.state_machine import Standing

_OF_STATE = {
    State.ACTIVE: StateBits.ACTIVE,
    State.BYPASS: StateBits.BYPASS,
    State.FAULT: StateBits.FAULT,
}
_OPENABLE = (State.READY, State.ARMED, State.ACTIVE, State.FADING)


def state_word(standing: Standing, *, zeros_sent: bool, saturated: bool, comm_warn: bool) -> int:
    """Return the bits of ``StateBits``.

    FADING is set in any closed state until zeros have been sent: without the bit the PLC takes no
    correction, zero included, and would ramp down from the last one that was not zero.
    """
    bits = int(_OF_STATE.get(standing.state, 0))
    if standing.state in _OPENABLE:
        bits |= StateBits.READY
    if standing.armed:
        bits |= StateBits.ARMED
    if standing.state is not State.ACTIVE and not zeros_sent:
        bits |= StateBits.FADING
    if saturated:
        bits |= StateBits.SATURATED
    if comm_warn:
        bits |= StateBits.COMM_WARN
    return int(bits)
