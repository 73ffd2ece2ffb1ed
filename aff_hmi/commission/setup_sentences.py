"""The sentences of setup's interview: its questions, its rows, what it says and complains of."""

from __future__ import annotations

from aff_hmi.words import N_

_BIT = (
    N_("LINE_RUN: the line runs. word.bit such as 20.7, `20.7 inverted`, find, none"),
    N_(
        "AFF_ENABLE_REQUEST: the PLC lets AFF correct. word.bit such as 20.7, `20.7 inverted`, "
        "find, none"
    ),
    N_("WEB_INTACT: no web break. word.bit such as 20.7, `20.7 inverted`, find, none"),
    N_(
        "TENSION_VALID: the tension reading may be used. word.bit such as 20.7, `20.7 inverted`, "
        "find, none"
    ),
    N_("ESTOP_OK: no emergency stop. word.bit such as 20.7, `20.7 inverted`, find, none"),
    N_(
        "REMOTE: the line is in remote operation. word.bit such as 20.7, `20.7 inverted`, find, "
        "none"
    ),
    N_("SPLICE_ACTIVE: a splice runs. word.bit such as 20.7, `20.7 inverted`, find, none"),
    N_("RESET_EDGE: reset of AFF's fault. word.bit such as 20.7, `20.7 inverted`, find, none"),
)
QUESTIONS = (
    N_("How is the PLC reached? {words}"),
    N_("Address of the PLC, such as 192.168.7.10"),
    N_("Port"),
    N_("Unit identifier"),
    N_("First word to look at, as a wire address (the manual's first register is 0)"),
    N_("How many words to look at"),
    N_("Name of the line"),
    N_("Name of a second driven roller to correct, such as swrap_follower; or none"),
    N_(
        "Channel of the web tension behind {roll}; refine finds it by its name in the line file, "
        "such as pullroll_tension_N"
    ),
    N_(
        "Further channel to record, such as r3_tension_N; refine finds it by its name in the line "
        "file; none ends"
    ),
    N_("Word with the correction of {roll} that the PLC really adds; or none"),
    N_("Word that counts splices (a new roll); one that stands still where there is none"),
    N_("Word with the PLC's copy of our heartbeat (aff_echo); or none"),
    N_(
        "First of the {count} words that AFF writes, in the order of "
        "docs/technician/gateway-block.md (wire address)"
    ),
    N_("One count of a correction word, m/s (the PLC's own scale)"),
    N_("Word with the status bits of the PLC"),
    N_("Has it AFF's own order of bits (docs/technician/gateway-block.md)? yes, no"),
    *_BIT,
    N_("Highest speed of normal operation"),
    N_("Highest web tension"),
    N_("Radius of the empty core"),
    N_("Radius of the full roll"),
    N_("Which reference of the drive takes the correction? velocity, torque"),
    N_("Largest correction that the PLC allows at the unwind"),
    N_("Radius of {roll} (half its diameter)"),
    N_("Largest correction that the PLC allows at {roll}"),
    N_("Amplitude of the probe's excitation, m/s; none: chosen from the noise"),
    N_("Function codes"),
    N_("Law: shape, whose drive the probe finds where you do not know it, or blocks"),
    N_("Speed loop: proportional gain over inertia, rad/s; none: the probe finds it"),
    N_("Damping of the speed loop"),
    N_("Inertia of core, chuck and coupling, kg m2; none: the probe finds it"),
    N_("Density of the wound web, kg/m3; none where it is not known"),
    N_("Width of the web"),
    N_("Outer radius of the core itself"),
    N_("Usual web tension"),
    N_("Which number has word {word} (the heartbeat) in the PLC's manual or program?"),
    N_("Which is the PLC's heartbeat?"),
    N_("What does the drive show now as {what}, all digits and the unit?"),
    N_("What does the drive show now as {what}, all digits and the unit, or skip?"),
    N_("web tension behind the unwind"),
    N_("set point of that tension"),
    N_("line speed"),
    N_("set point of the line speed behind its ramp"),
    N_("radius of the unwind roll (half its diameter)"),
    N_("speed of {roll}"),
    N_("web tension behind {roll}"),
    N_("encoder of {roll}"),
    N_("Which one? `again`: type the value at another moment, which decides more surely"),
    N_(
        "Which one? `again`: type the value at another moment, which decides more surely; `move`: "
        "move it, and see which word follows"
    ),
    N_(
        "Leave the line as it shall be while you move it (running, or stopped with its web), then "
        "Enter"
    ),
    N_(
        "Enter; then, within {seconds} s, move this alone for some seconds: {what}; change it at "
        "the drive"
    ),
    N_(
        "Enter; then, within {seconds} s, move this alone for some seconds: {what}; at a stopped "
        "line press on the roller of its load cell, or lift its dancer; at a running one change "
        "the set point of its zone, which one on draw behind it follows"
    ),
    N_("Which one?"),
    N_("Does the PLC show the {what}, and does the line run now? yes, skip"),
    N_("Is it so now? yes, no"),
    N_("Change it (press, switch, stop), wait a second, then Enter"),
    N_("The PLC is gone; what was found is kept. Enter: try again; q: leave"),
    N_("{site} is there already. Replace it? yes, no"),
)
SAID = (
    N_("the PLC gives {count} words"),
    N_("the PLC gives {count} words; it refuses the other {others}"),
    N_("word {word} = {value}  {what}"),
    N_("the others are still and 0"),
    N_("watching, {seconds} s at most, until the count starts over"),
    N_("{name}: {answer} (kept)"),
    N_("{channel}: {decoding}, scale {scale} (kept)"),
    N_("wrote {site}"),
    N_("{site} stays as it is; what was answered is in {path}"),
    N_("the site file stays as it is"),
    N_("left; what was answered is kept"),
    N_("a correction goes out; bypass first"),
    N_("no site file is there"),
    N_("no word fits. Type all digits that the display has, and the right unit."),
    N_("word {word} changed by {value} {unit}, at rest {swing}"),
    N_("no word moved further than at rest: move it more, or longer"),
    N_("no row moved; words that did: {words}"),
    N_("several rows moved alike: move one thing alone"),
    N_("no row is taken unasked: {why}. Write {choices}."),
    N_("rows {words} fit alike, and a wrong word in the loop moves the web"),
    N_("the scale of row 1 is not round"),
    N_("no row stood out when it was moved"),
    N_("another word or number can be it too"),
    N_(
        "its end was not seen in {seconds} s: watch again at a higher speed, or take one word or "
        "two, and where it starts over, from the PLC's manual"
    ),
    N_("several words count up like a scan"),
    N_("several bits changed with it"),
    N_("no word turns as this roll does at this line speed. Does it run?"),
    N_("{site}: somebody has saved it meanwhile; look at it, then begin again. {rest}"),
    N_(
        "no word counts up each scan. AFF needs one: let the PLC add 1 to a word in every scan, "
        "then run setup again."
    ),
    N_('"{text}": write a whole number, {low} to {high}.'),
    N_('"{text}": write {choices}.'),
    N_(
        '"{text}": write word and bit such as 20.7 (bit 0 to 15), `20.7 inverted` where 0 means '
        "yes, `find`, or `none`."
    ),
    N_('"{text}" is not known. {why}'),
    N_("Did you mean {choices}?"),
    N_("Known here: {choices}."),
    N_('"{text}" is out of range: above {low}, up to {high} {unit}.'),
    N_("{count} characters. Write 1 to {most}."),
    N_("word {word} is {owner} already."),
    N_("{name} is asked for already. Write another name."),
    N_("{name} is in {other}. Name a channel in {unit}."),
    N_("{name} does not end with its SI unit. Let it end with one of: {words}."),
    N_(
        "{name} is an angle: setup finds the encoders of corrected rolls alone. Write others into "
        "the site file, by the manual (docs/config-reference.md)."
    ),
    N_("word {word} is outside the window {first} to {last}."),
)
ROWS = (
    N_("{what}: {value} with scale {scale}; {why}"),
    N_("word {word}: {why}"),
    N_("{what}: {scale}; {why}"),
    N_("word {word} {type}"),
    N_("{scale} is round"),
    N_("the scale is not round"),
    N_("near what was typed with the same scale"),
    N_("changed by {value} {unit}"),
    N_("moves"),
    N_("stands still"),
    N_("still"),
    N_("it counts or ramps"),
    N_("agrees at {count} moments"),
    N_("measured {count} counts/turn ({low} to {high})"),
    N_("in less than one turn"),
    N_("not this number if radius and line speed are right"),
    N_("then no word is left that can be {roll}"),
    N_("one word"),
    N_("its low word"),
    N_("wraps at 65536"),
    N_("word {word} takes its carry"),
    N_("no carry into {word} seen"),
    N_("its end was not seen in {seconds} s"),
    N_("counts every {period} ms"),
    N_("a scan of {period} ms"),
    N_("counts up by {rate} a second"),
    N_("ramps by {rate} a second"),
    N_("counts up by {rate} a second, starts over at {count}"),
    N_("ramps by {rate} a second, starts over at {count}"),
    N_("noisy: {mean} +- {sd}"),
    N_("bits that change: {bits}"),
)
SETUP = (*QUESTIONS, *SAID, *ROWS)
