"""Why a step of the card is refused, or is due again, as patterns of the reader's language."""

from __future__ import annotations

from aff_hmi.words import N_

CARD = (
    # the file of the card
    N_("{site}: there is a card already; name another folder"),
    N_("{site}: somebody has added to it meanwhile; do it again"),
    N_("{site}: somebody has saved it meanwhile; do it again"),
    N_("{site}: the entry is longer than {count} kB"),
    N_("{site}: the card is full; begin another one"),
    N_(
        "{site}: {reason}; nothing was added. Free the disk, or run the command as who may write "
        "there"
    ),
    N_("{site}: {reason}; no card there"),
    N_("{site}: {reason}; the site file is not kept beside the card"),
    N_("{site}: another command writes this card"),
    N_("{site}: {reason}: no card of ours"),
    N_(
        "{site}: {reason}; name a card's folder, or begin one with `aff-runtime card new "
        "SITE.yaml CARD_DIR`"
    ),
    N_("{site}: the chain does not hold: {reason}"),
    N_("{site}: no card of this release: {why}"),
    N_("{site}: too much for one entry: {reason}"),
    N_("entry 1: a card begins with what it is of, once; no card of ours"),
    N_("entry {number}: of a kind that this release does not know"),
    N_("entry: {text} is no verdict of a step"),
    N_("entry: a sample's names and numbers are not alike; no card of ours"),
    N_("{thing}: read {text}, expected an object; no card of ours"),
    N_(
        "{thing}: read {text}, expected {reason}; it was written by another release, or by "
        "something else"
    ),
    # what is typed
    N_("no step {step}; the card has {least} to {most}"),
    N_("the name has {count} characters; write {least} to {most}"),
    N_("{name}: expected a number in {unit}, or in a unit of that kind"),
    N_("{name}: expected a plain number, or in a unit of that kind"),
    N_("{name}: has a decimal comma; write {value}"),
    N_("{name}: this step does not ask for it; it asks for {rest}"),
    N_("--typed {text}: expected name=value, or 'name=value unit', such as 'load=20 lbf'"),
    N_("step 1: type the load that hangs there: load=0, or load=20 lbf"),
    N_("step 1: type which cell: signal={rest}"),
    N_("step 11: type which: trip={rest}"),
    N_("step 11: {name} ends the record: type when the PLC shows zero: time=80 ms"),
    # records, settings and the service
    N_("no record: name a window of one (on the console: --run RUN_DIR@FROM..TO)"),
    N_("step {step} looks at no record; leave --run out"),
    N_("{name}: settings were changed in it"),
    N_(
        "{name}: which settings ran in it cannot be told: they were changed at {seconds} s; name "
        "a window before that"
    ),
    N_(
        "{name}: which settings ran in it cannot be told: its events cannot be read to the end; "
        "measure anew"
    ),
    N_(
        "{name}: recorded on other settings ({hash}, in force from {seconds} s on) than the site "
        "file says now ({other})"
    ),
    N_("{name}: recorded on other settings ({hash}) than the site file says now ({other})"),
    N_("{name}: no reading of the line speed in it"),
    N_("{name}: no reading of {channel} in it"),
    N_("{name}: the correction is not tripped in it"),
    N_("{name}: ends less than {seconds} s after the trip; take it longer"),
    N_(
        "the service runs on other settings ({hash}) than the site file says ({other}); see "
        "`aff-runtime status`"
    ),
    N_("other settings are being tried; keep or undo them first"),
    N_("the former settings return already ({why})"),
    # step 9
    N_("no actuator {name}; there are {rest}"),
    N_("{actuator}: none of its blocks is enabled"),
    N_("step 9: nothing was tried"),
    N_("the correction is not on: the service is {state}; arm it"),
    N_("the line stands or is too slow for a search"),
    N_("nothing is recorded: no search"),
    # signing, and what is due again
    N_("step {step} is {stand}: nothing to sign"),
    N_("step {step} is {stand} ({why}): nothing to sign"),
    N_("step {step} signed as {name}; {what}"),
    N_("roll not compared"),
    N_("machine not compared"),
    N_("program of the PLC not compared"),
    N_("site file not compared"),
    N_("site file, {what} not compared"),
    N_("measured responses of {name} not compared"),
    N_("not compared with what holds now: {why}"),
    N_("no service answers: roll not compared"),
    N_("site file: {hash}, now {other}"),
    N_("site file, {what}: {hash}, now {other}"),
    N_("program of the PLC: {text}, now {rest}"),
    N_("roll: {hash}, now {other}"),
    N_("machine: {text}, now {rest}"),
    N_("measured responses of {name}: {hash}, now {other}"),
    N_("cycle and speed of the line"),
    N_("channels and their scales"),
    N_("wire and its other words"),
    N_("permissives and believable ranges"),
    N_("freshness"),
    N_("rolls"),
    N_("signal and output of the actuators"),
    N_("limits and ramps of the actuators"),
    N_("law, drive and noise of the actuators"),
    N_("orders, amplitudes, settle_s and memory_turns"),
)
