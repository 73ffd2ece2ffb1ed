"""The event table: every fault of the cycle, its reaction, and the operator's sentence."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum


class Reaction(IntEnum):
    """What an event does to the output, weakest first."""

    NOTE = 0
    HOLD = 1
    FADE = 2
    FADE_AND_LATCH = 3


@dataclass(frozen=True, slots=True)
class Event:
    """One row: ``code`` goes to the PLC's alarm word."""

    code: int
    name: str
    reaction: Reaction
    text: str
    action: str


TABLE: tuple[Event, ...] = (
    Event(0, "NONE", Reaction.NOTE, "no alarm", "nothing"),
    Event(
        1,
        "PLC_STALE",
        Reaction.FADE_AND_LATCH,
        "PLC data is stale",
        "check the PLC heartbeat and the network, then arm again",
    ),
    Event(
        3,
        "BLOCK_CLAMPED",
        Reaction.HOLD,
        "a block is at its limit",
        "raise the limit or find the mechanical cause",
    ),
    Event(
        4,
        "RIPPLE_ROSE",
        Reaction.FADE_AND_LATCH,
        "ripple rose since enable",
        "run the probe again before arming",
    ),
    Event(
        5,
        "PHASE_UNSURE",
        Reaction.HOLD,
        "phase error of a block may exceed 60 degrees",
        "probe at this speed and radius",
    ),
    Event(
        6,
        "RADIUS_JUMP",
        Reaction.FADE_AND_LATCH,
        "roll radius jumped or is not monotone",
        "confirm the splice, then arm again",
    ),
    Event(
        8,
        "OVERRUN",
        Reaction.FADE_AND_LATCH,
        "control cycle overran three times in a row",
        "check CPU load and real-time rights, then arm again",
    ),
    Event(
        9,
        "TENSION_IMPLAUSIBLE",
        Reaction.FADE_AND_LATCH,
        "tension is NaN, stuck or out of range",
        "check the load cell, then arm again",
    ),
    Event(
        10,
        "CONFIG_DIFFERS",
        Reaction.NOTE,
        "site file differs from the running one",
        "correct the site file",
    ),
    Event(
        11,
        "PERMISSIVE_LOST",
        Reaction.FADE,
        "a permissive of the PLC went away",
        "see status for its name",
    ),
    Event(
        12,
        "SIGNAL_IMPLAUSIBLE",
        Reaction.FADE_AND_LATCH,
        "a speed, angle or radius is NaN or out of range",
        "check the signal named in status",
    ),
    Event(
        13,
        "SUPERVISOR_LOST",
        Reaction.FADE_AND_LATCH,
        "the supervisor process is gone",
        "restart the service",
    ),
    Event(
        14,
        "INTERNAL_FAULT",
        Reaction.FADE_AND_LATCH,
        "internal fault in the control cycle",
        "save the run folder and restart the service",
    ),
    Event(15, "POWER_UP", Reaction.FADE_AND_LATCH, "just started", "arm when ready"),
    Event(
        16,
        "LEASE_EXPIRED",
        Reaction.FADE_AND_LATCH,
        "the law stopped renewing its output",
        "save the run folder and restart the service",
    ),
    Event(17, "SPLICE", Reaction.FADE, "splice or roll change", "arms itself again when clear"),
    Event(
        18, "BYPASSED", Reaction.FADE_AND_LATCH, "bypassed, or a probe has ended", "arm to return"
    ),
    Event(
        19,
        "SECOND_MASTER",
        Reaction.FADE_AND_LATCH,
        "aff_echo is not ours: the PLC takes the commands of somebody else, or of nobody",
        "leave one runtime alone on a PLC that copies aff_heartbeat to aff_echo, then arm again",
    ),
    Event(
        20,
        "APPLIED_DIFFERS",
        Reaction.FADE_AND_LATCH,
        "the PLC adds a correction to the drive that we did not send",
        "find the station that writes to the PLC beside us, or the fault in the applied word, "
        "then arm again",
    ),
)
BY_NAME = {event.name: event for event in TABLE}
BY_CODE = {event.code: event for event in TABLE}
STALE_BEGAN = "PLC_STALE began with: "
"""In front of a trouble of the wire that ended in the loss of the PLC; it may be over."""
