"""Sentences of refining and maintenance that are told in the reader's language, as patterns."""

from __future__ import annotations

from aff_hmi.words import N_

RUNS = (
    # what a record lacks
    N_("no roll angle is recorded: orders rest on simulated angles"),
    N_("no web speed is recorded: wavelengths rest on the speed reference"),
    N_("one speed only: a line in time and a line in travel look the same"),
    N_("one tension only: where an effect sits rests on the drive speeds"),
    N_(
        "a wrong scale or zero of the load cell that a tension loop controls: its integral hides "
        "it"
    ),
    N_(
        "no speed reference: the measured speed stands in, some 100 ppm off; at which of several "
        "like idlers of a zone an effect sits is not told, nor what only the drives' common speed "
        "shows"
    ),
    N_(
        "no step of the tension reference: the modulus, a loop's gains and a delay are told by "
        "ripple alone"
    ),
    N_(
        "the unwind roll keeps its radius: an order of it and a roller of that radius look the "
        "same"
    ),
    N_("not recorded: {thing}; {why}"),
    N_("where an effect sits rests on fewer channels"),
    N_("nothing tells what happens from {rest}"),
    N_(
        "when a correction of {actuator} acted is not recorded, the usual delay is taken: a delay "
        "of that drive is not told from it (map aff_echo or applied)"
    ),
    N_("no held-out record: the error after is that of the record fitted"),
    N_("more than one held-out record: the errors are those of {name}"),
    N_("by their site files the runs are of several lines: {rest}; are they of this one?"),
    # what stands against refining here
    N_(
        "no line file: start the commissioner with --line LINE.yaml, a copy of "
        "config/lines/euclid.yaml with your rollers, web and sensors"
    ),
    N_(
        "sim-plant is not installed whole beside this commissioner: on a gateway install.sh "
        "--plant brings it, or give the command below on another machine that has line file, "
        "site file and runs"
    ),
    N_("{path}: the line file is not there; copy yours there"),
    N_("{path}: no site file is there"),
    N_("{path}: holds no run with rows yet"),
    N_(
        "a correction goes out and this machine has {count} processors: bypass first, or give the "
        "command on another machine"
    ),
    # what became of it
    N_("choose at least one window to fit"),
    N_("effects are left out by their names, such as roll_bounce"),
    N_("looked at; every window can be used"),
    N_("looked at; not every window can be used"),
    N_("refinement {number}: {rest}"),
    N_("it has come to no verdict"),
    N_("no refinement {number} is kept; the last {count} are"),
    N_(
        "the site file is another one since this refinement began: refine again, so that nothing "
        "of it is lost"
    ),
    N_("the site file says so already"),
    # over weeks
    N_("{path}: holds no store; `aff-runtime watch add STORE RUN_DIR` begins one"),
    N_("none of the rollers in place has been read yet: runs at a steady speed are needed"),
    N_(
        "{roll}: no line, {count} whole turns in its longest steady stretch, {number} are needed, "
        "{seconds} s at one speed"
    ),
    N_("{roll}: no line, {count} whole turns in its longest steady stretch, {number} are needed"),
    N_("runs tried: {count}, left out: {others}"),
    N_("{roll}: a new life from {when} UTC"),
)
