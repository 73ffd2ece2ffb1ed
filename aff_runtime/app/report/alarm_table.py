"""Which events are alarms, and how soon somebody has to act (ISA-18.2).

An alarm is what asks for an operator's step. What comes back by itself, what an operator did, and
a start are events.
"""

from __future__ import annotations

from enum import StrEnum


class Priority(StrEnum):
    """How soon an operator has to act."""

    HIGH = "high"
    MEDIUM = "medium"
    LOW = "low"


PRIORITIES: dict[str, Priority] = {
    "SECOND_MASTER": Priority.HIGH,  # somebody else writes to the PLC
    "APPLIED_DIFFERS": Priority.HIGH,  # somebody else moves the web
    "RIPPLE_ROSE": Priority.HIGH,  # the correction made it worse
    "PLC_STALE": Priority.MEDIUM,
    "RADIUS_JUMP": Priority.MEDIUM,
    "OVERRUN": Priority.MEDIUM,
    "TENSION_IMPLAUSIBLE": Priority.MEDIUM,
    "SIGNAL_IMPLAUSIBLE": Priority.MEDIUM,
    "SUPERVISOR_LOST": Priority.MEDIUM,
    "INTERNAL_FAULT": Priority.MEDIUM,
    "LEASE_EXPIRED": Priority.MEDIUM,
    "BLOCK_CLAMPED": Priority.LOW,
    "PHASE_UNSURE": Priority.LOW,
    "CONFIG_DIFFERS": Priority.LOW,
}
EVENTS = frozenset({"NONE", "PERMISSIVE_LOST", "SPLICE", "POWER_UP", "BYPASSED"})
