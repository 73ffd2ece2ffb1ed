"""What a step of the card wants typed, in words: the names of the card are for a console."""

from __future__ import annotations

from aff_hmi.words import N_, Say

LIMITS = 3  # the step at which a name is that of an actuator
OF_STEP = {
    (1, "load"): N_("weight that hangs on the load cell; 0 without web and weight"),
    (1, "signal"): N_("which load cell, where not all are loaded"),
    (3, "warnings_understood"): N_("how many warnings you have read and understood"),
    (4, "reaction"): N_("what the drive did: zero, ramp or hold"),
    (4, "time"): N_("how long it took"),
    (5, "base_reference"): N_("after what time the drive had its own reference again"),
    (9, "actuator"): N_("which actuator"),
    (11, "trip"): N_("which trip"),
    (11, "time"): N_("for restart and kill: when the PLC showed zero"),
    (12, "promised"): N_("reduction that was promised, dB"),
    (12, "settle"): N_("how long an on is left alone before it counts"),
}
LIMIT_OF = N_("limit of {name} in the PLC")
SIGN_OF = N_("sign by the geometry at {name}: 1 or -1")
SIGN = "sign_"


def wanted(step: int, name: str, say: Say) -> str:
    """Return what is to be typed, in the reader's language; a channel is its own name."""
    if (step, name) in OF_STEP:
        return say(OF_STEP[step, name])
    if step == LIMITS:
        return say(LIMIT_OF).replace("{name}", name)
    if name.startswith(SIGN):
        return say(SIGN_OF).replace("{name}", name.removeprefix(SIGN))
    return name
