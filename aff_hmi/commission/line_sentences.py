"""What the service and the check say of a line, as patterns of the reader's language.

What came of a probe, what became of a shape, how the service is reached, and the orders and limits
of the site file. Errors and warnings of the check stay English.
"""

from __future__ import annotations

from aff_hmi.words import N_

PROBES = (
    N_("not in operation (state {state})"),
    N_("did not end in {seconds} s (state {state})"),
    N_("aborted"),
    N_("the fit cannot start: {reason}"),
    N_("the fit failed ({reason}); probe again"),
    N_("the probe did not finish: {why}"),
    N_(
        "{actuator}: {share} of readings can be used, {least} are needed. Does the PLC scan more "
        "slowly than every {ms} ms (cycle_ms)? Else the wire loses them; probe again"
    ),
    N_("{actuator}: no tones, or too many for this duration"),
    N_("{actuator}: the excitation did not go out"),
    N_(
        "{signal} moved {beyond} beyond what it did before the probe, the bound is {most}; was it "
        "the probe, lower probe.bound_m_s, else wait until the line is steady"
    ),
    N_(
        "the line speed went from {mean} to {speed} m/s; a probe bears {share}: probe again when "
        "the speed stands"
    ),
    N_(
        "too few readings were new to choose the amplitude. Does the PLC scan more slowly than "
        "cycle_ms? Else the wire loses them; probe again"
    ),
    N_("{actuator}: the probe is not heard within its bound; {what}"),
    N_(
        "nothing answers {level} {unit}: is the correction wired and let in at the drive? Else "
        "raise {key}"
    ),
    N_("{peak} {unit} would be needed, {level} may be: raise {key}"),
    N_(
        "{peak} {unit} would be needed, {level} may be: raise {key}, or probe.duration_s to "
        "{seconds}"
    ),
    N_("{path}: {reason}; the response is not kept"),
)
SHAPES = (
    N_("the shape saved {time}"),
    N_("the start shape of the site file"),
    N_(
        "{actuator}: {what} waits for its trial: it takes {seconds} s and {turns} turns of every "
        "roll with the line running; arm after that"
    ),
    N_(
        "{actuator}: the saved shape was learned with other rolls, or another encoder, drive or "
        "signal; the rolls are learned anew"
    ),
    N_(
        "{actuator}: the shape saved {time} keeps its shape; its correction of P is of another "
        "response and is learned anew"
    ),
    N_(
        "{actuator}: the shape saved {time} keeps its shape; its correction of P is of a response "
        "that it does not name and is learned anew"
    ),
    N_("{actuator}: {what} is not used: {why}"),
    N_("{actuator}: {roll}: {what} is not used: {why}"),
    N_("learning began before its trial was over; the roll is learned anew"),
    N_("it is of roll {number}, now there is roll {other}"),
    N_("it was learned at radius {radius} m, now it is {now} m"),
    N_("the ripple is another (agreement {agreement}, size {size}); learned anew"),
    N_("{actuator}: {roll}: starts from {what}; there is no ripple to try it on"),
    N_("{actuator}: {roll}: starts from {what} (agreement {agreement}, size {size})"),
    N_(
        "{actuator}: {roll}: starts from {what} (agreement {agreement}, size {size}, turned by "
        "{angle} deg: the encoder's origin has moved)"
    ),
    N_("{actuator}: roll {number} in the place of roll {other}: the shape of {rest} is forgotten"),
    N_(
        "{actuator}: an unknown roll in the place of roll {other}: the shape of {rest} is "
        "forgotten"
    ),
    N_("{actuator}: the shape of {rest} is forgotten"),
    N_("{actuator}: the learned shape is not finite and is not saved"),
    N_("{actuator}: {path}: {reason}; the shape is not kept"),
    N_("{actuator}: what was learned is kept in {path}"),
    N_("{file}: {reason}; the roll is learned anew"),
    N_("{file}: not a shape file: {reason}; the roll is learned anew"),
)
SERVICE = (
    N_("settings {hash} by {name}"),
    N_("{path}: the service does not answer ({reason})"),
    N_("{path}: the service closed the connection; see its log"),
    N_("{path}: the answer cannot be read; is it another release?"),
    N_(
        "{path}: no service answers ({reason}); start it with `aff-runtime run SITE.yaml`, or "
        "name its --runtime-dir"
    ),
)
CHECK = (
    N_(
        "{actuator}: {roll} {order}x at {speed} m/s, R {radius} m: {frequency} Hz = {rpm} rpm, "
        "{count} samples per period"
    ),
    N_(
        "{actuator}: law shape at {speed} m/s, R {radius} m: {count} of {all} orders of {roll} "
        "below {low} Hz; memory {turns} turns = {seconds} s"
    ),
    N_(
        "{actuator}: law shape at {speed} m/s, R {radius} m: {count} of {all} orders of {roll} "
        "below {low} Hz, {fading} fade; memory {turns} turns = {seconds} s"
    ),
    N_(
        "{actuator}: law shape at {speed} m/s, R {radius} m: {count} of {all} orders of {roll} "
        "below {low} Hz, {resting} above {high} Hz rest; memory {turns} turns = {seconds} s"
    ),
    N_(
        "{actuator}: law shape at {speed} m/s, R {radius} m: {count} of {all} orders of {roll} "
        "below {low} Hz, {fading} fade, {resting} above {high} Hz rest; memory {turns} turns = "
        "{seconds} s"
    ),
    N_("{key}: {value} = {count} counts"),
)
LINE = (*PROBES, *SHAPES, *SERVICE, *CHECK)
