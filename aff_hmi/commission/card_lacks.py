"""What a step of the card still waits for, as patterns of the reader's language."""

from __future__ import annotations

from aff_hmi.words import N_

LACKS = (
    N_("no figure: {name}"),
    # what is to be typed
    N_("type the PLC's limit: {name}=... {unit}"),
    N_("read the warnings one by one, then type {name}={count}"),
    N_("type what the drive did: reaction=zero, ramp or hold"),
    N_("type how long it took: time=120 ms"),
    N_("type what the display shows: {name}=... {unit}"),
    N_("type when the PLC showed the base reference: {name}=200 ms"),
    N_("{channel}: measure without web and load, and type load=0"),
    N_("{channel}: measure with the span weight, and type load=20 lbf"),
    N_("make the trip, and type trip={name}"),
    # what a record lacks
    N_(
        "heartbeat: in each rest that is too long, up to {count} ms, the service missed or began "
        "late a tick of its own, which says nothing of the PLC: again on a machine that keeps its "
        "ticks"
    ),
    N_("no PLC_STALE begins in the window: pull the plug while it is recorded"),
    N_("the plug was not pulled in shadow"),
    N_("{roll}: its angle is not known in the window"),
    N_("no arming in the window: begin it some turns before"),
    N_("stay armed for more than {seconds} s, and some turns"),
    N_("no corrected order stands out of the noise"),
    N_("no corrected order fell by more than its error: stay off, and on, for more turns"),
    N_("no order is computed: arm, and wait until they have settled"),
    N_("the correction is not on: the service is {state}"),
    N_("the correction is not on: the service is not there"),
    # responses
    N_("{actuator}: probe it (PROBE at the screen, or `aff-runtime probe`)"),
    N_("{actuator}: once more at {speed} m/s"),
    N_("{actuator}: once more at {speed} m/s, radius {radius} m"),
    N_("{actuator}: {count} more speeds or radii"),
    N_("{actuator}: no sign can be told ({reason}): probe lower or louder"),
    # the search
    N_("{value} was not measured to its end: {why}; arm, and search again"),
    N_(
        "{value} has no ripple: fewer whole turns than an interval needs, with good angle and "
        "readings; look at the record, arm, and search again"
    ),
    N_("ripple still fell at {value}: keep it, arm, and search again from there"),
    N_("the search was ended before its end; arm, and search again"),
    # the proof
    N_(
        "off, on, off, on is not in the window, each long enough (on: {seconds} s to settle, and "
        "{count} turns)"
    ),
    N_(
        "nothing is proven: no corrected order stands out of the noise in both pairs; make each "
        "off, and each on behind its settling, {count} turns of the largest roll long"
    ),
    N_("{what}: whole turns: {count}, {least} are needed; make it longer, or type settle"),
    N_(
        "{what}: whole turns of {roll}: {count}, {least} are needed; make it longer, or type "
        "settle"
    ),
    N_("first off"),
    N_("first on"),
    N_("second off"),
    N_("second on"),
)
