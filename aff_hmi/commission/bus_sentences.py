"""The sentences of setup's interview on a bus whose DBC or EDS files name every signal."""

from __future__ import annotations

from aff_hmi.words import N_

QUESTIONS = (
    N_("CAN interface of this machine: {words}"),
    N_("Its channel, such as can0, or the tty of an adapter"),
    N_("Bit rate, bit/s"),
    N_("DBC file, beside the site file"),
    N_("Our own CANopen node id, which no device has"),
    N_("CANopen node: name, node id and EDS file, such as unwind_drive 3 drive.eds; none ends"),
    N_(
        "Listen to the bus, to show the present value beside each signal's name? Nothing is sent. "
        "yes, no"
    ),
    N_("Scan time of the PLC, ms"),
    N_("Which signal, that AFF reads, is this: {what}?"),
    N_("Which signal, that AFF sends, is this: {what}?"),
    N_("counter that the PLC raises each scan (heartbeat)"),
    N_("status bits of the PLC, in AFF's own order"),
    N_("counter of splices (a new roll)"),
    N_("the PLC's copy of our heartbeat (aff_echo)"),
    N_("our heartbeat"),
    N_("our state"),
    N_("our echo of the PLC's heartbeat"),
    N_("our alarm"),
    N_("limit in force"),
    N_("revision of our site file"),
    N_("correction of {roll}, added to the drive's speed reference behind its ramp"),
    N_("ones complement of the correction of {roll}"),
    N_("correction of {roll} that is really added (applied)"),
    N_("Counts of one turn of {name} ({channel}), from the manual, such as 4096 counts/turn"),
    N_("{unit} in one count of {name} ({channel}), from the manual, such as {value}, or {text}"),
    N_("One count of {name}, m/s at the web, as the drive's velocity unit is set; see its manual"),
    N_(
        "Object 0x6007 of {name}: its reaction to our lost heartbeat, a number of the drive's "
        "manual; none: not set"
    ),
)
SAID = (
    N_("the files name {count} signals"),
    N_("{count} of them come"),
    N_("going on without values: the names of the files alone decide"),
    N_(
        "no frame of the files came. CANopen nodes send after `aff-runtime run` has started them; "
        "CAN by DBC: check bit rate, wiring and identifiers"
    ),
    N_("{channel}: scale {scale}, by its unit in the file"),
    N_("their names do not tell them apart, and a wrong signal in the loop moves the web"),
    N_("no name says that it is this"),
    N_('"{text}": there is no such file in {path}.'),
    N_("{name}: which EDS file? Write it behind the node id."),
    N_("{name} is something else already. Name another one."),
)
BUS = (*QUESTIONS, *SAID)
