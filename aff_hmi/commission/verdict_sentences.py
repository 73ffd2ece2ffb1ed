"""Sentences of a verdict of refine that are told in the reader's language, as patterns.

An effect whose words are not here is told in English: a new one needs no line of this file.
"""

from __future__ import annotations

from aff_hmi.words import N_

NAMES = (
    N_("out of round roll at {place}"),
    N_("eccentric roller at {place}"),
    N_("unbalanced roller at {place}"),
    N_("unbalanced measuring roller at {place}"),
    N_("bearing drag at {place}"),
    N_("web modulus at {place}"),
    N_("viscoelastic web at {place}"),
    N_("wound in strain at {place}"),
    N_("thermal strain at {place}"),
    N_("slip at {place}"),
    N_("splice at {place}"),
    N_("roll bounce at {place}"),
    N_("load cell filter at {place}"),
    N_("load cell resonance at {place}"),
    N_("load cell calibration at {place}"),
    N_("mains hum at {place}"),
    N_("shaft compliance backlash at {place}"),
    N_("torque ripple at {place}"),
    N_("nip pulse at {place}"),
    N_("loop delay at {place}"),
    N_("rate limit at {place}"),
    N_("radius error at {place}"),
    N_("encoder eccentricity at {place}"),
)
"""What an effect is called, at its place."""

TEXTS = (
    N_("a bearing turns harder than declared: tension steps across the roller"),
    N_("a roller turns off its centre: ripple once per turn in both its spans"),
    N_("an encoder off its centre: its speed wobbles once per turn while the roller runs even"),
    N_("a load cell reads a wrong scale or zero: the loop holds the reading, not the tension"),
    N_("a load-cell amplifier filters more than declared: readings and loop lag"),
    N_("a load cell rings on its mounts: one frequency is amplified in its reading"),
    N_("corrections reach their drive late: the tension loop rings more"),
    N_("mains pick-up in a reading: a line in time, often an alias, that no roller explains"),
    N_("a nip roller presses unevenly: its driven roller is braked once per turn of the nip"),
    N_("the roll is not round: ripple at its turning frequency and several harmonics"),
    N_("a drive believes a wrong radius or gear ratio: its roller runs fast or slow"),
    N_("a drive believes too large a radius, or a wrong gear ratio: its roller runs slow"),
    N_("a drive believes too small a radius, or a wrong gear ratio: its roller runs fast"),
    N_(
        "a drive ramps its reference or its correction, or a tension loop its output: fast "
        "changes come out slower"
    ),
    N_("the roll bounces on its mandrel: a fixed frequency that an order of the roll excites"),
    N_("a drive shaft twists or has play: the motor runs ahead of its roller"),
    N_("a drive shaft twists: the motor runs ahead of its roller under torque"),
    N_("a drive has play: the motor turns before its roller does"),
    N_(
        "the web slips on a driven roller above a speed and runs slower than it: tension drops "
        "before the roller and rises behind it, where no loop holds it"
    ),
    N_(
        "the web slips on a driven roller above a speed and is pulled ahead of it: tension rises "
        "before the roller and drops behind it, where no loop holds it"
    ),
    N_("from a splice on the web is another one: tensions change zone by zone as it passes"),
    N_(
        "a seam of another thickness is on the web: each roller pulls at another arm while the "
        "seam runs over it"
    ),
    N_("the web is warmer or moister in a zone: it is longer without being pulled"),
    N_("the web is cooler or drier in a zone: it is shorter without being let go"),
    N_("a drive pushes unevenly over its turn: ripple at a fixed number per turn of that roller"),
    N_("a measuring roller shakes its own cell once per turn, as speed squared"),
    N_("a body is heavier on one side: a torque once per turn that does not grow with speed"),
    N_("the web relaxes: tension creeps back after every change of strain"),
    N_("the web is stiffer than declared: the same draw pulls it tighter"),
    N_("the web is softer than declared: the same draw pulls it less"),
    N_("the roll was wound tighter than declared: it turns faster for the same web"),
    N_("the roll was wound looser than declared: it turns slower for the same web"),
)
"""What an effect is."""

REMEDIES = (
    N_("turn {place} by hand with the web off; clean, grease or change its bearings"),
    N_(
        "put a dial gauge on {place}: its total reading is twice the eccentricity; then have "
        "the roller, or its bearing seats, trued"
    ),
    N_("centre the encoder of {place} and its coupling"),
    N_("calibrate {place} with a known weight"),
    N_("compare the filter set in the amplifier of {place} with low_pass_Hz as declared"),
    N_("look for loose mounts at {place}"),
    N_("look for what is slow between load cell and drive {place}: task period, bus, filters"),
    N_("look at shield and earth of the cable of {place}"),
    N_("put a dial gauge on the nip roller of {place}, look at cover and closing cylinders"),
    N_("look how {place} was stored and clamped; the next roll brings a shape of its own"),
    N_("put radius or gear ratio in drive {place} right"),
    N_(
        "measure the radius of {place}: its drive believes too large a one, by what its ratio is "
        "above 1, or has a wrong gear ratio"
    ),
    N_(
        "measure the radius of {place}: its drive believes too small a one, by what its ratio is "
        "below 1, or has a wrong gear ratio"
    ),
    N_(
        "look at the ramp times of drive {place} and of its tension loop; let the tension "
        "correction enter behind them"
    ),
    N_("look for play in mandrel and chucks of {place}, or avoid the speed at which it rings"),
    N_("look for play in couplings, keys and gear of {place}"),
    N_(
        "look for play in couplings, keys and gear of {place}, and for a soft coupling or a thin "
        "shaft"
    ),
    N_(
        "look at what twists between motor and roller of {place}: coupling, shaft, belt; these "
        "records show no play"
    ),
    N_("clean the surface of {place}, give it more wrap or nip, or run slower"),
    N_("judge the webs before and after the splice on their own"),
    N_("look at the seam at that length of web: its overlap and its tape"),
    N_("measure the web's temperature before and after {place}"),
    N_("look at the commutation and the encoder offset of the motor of {place}"),
    N_("have the measuring roller {place} balanced"),
    N_("have {place} balanced"),
    N_("keep to the amended line; this web creeps, no setting is wrong"),
    N_("measure the stiffness of the web and put web.EA_N of the declaration right"),
    N_("ask how tight the roll at {place} was wound; put web.wound_in_tension_N right"),
)
"""What to do about it at the machine."""

VERDICT = (
    N_("Nothing found: the declared line explains the record fitted to its noise."),
    N_("Traced: {what}."),
    N_("Found: {what}."),
    N_("Unknown: {what}; no effect of the library explains it."),
    N_("{what} cannot be told from {why}."),
    N_("{what} or {roll} (not told apart)"),
    N_("{what} (not told apart)"),
    N_("To tell: {rest}."),
    N_("{what} scores {score}, the next best explanation ({why}) {next}"),
    N_("{what} scores {score}, no other explains the record as well"),
    N_(
        "{what} scores {score}, its rival ({why}) {next}: not told apart, for errors of the model "
        "may make that difference"
    ),
    N_("{what}: told apart, for errors of the model make up to {number}"),
    N_(
        "On the record judged the error in {channel} is {before} rms with {what}, {after} with "
        "{why} in its place."
    ),
    N_(
        "What begins at {number} s of {name} begins with a step of the line speed reference: the "
        "line's own answer to that may be what was found; record the step again."
    ),
    N_(
        "What begins at {number} s of {name} begins with a step of the tension reference: the "
        "line's own answer to that may be what was found; record the step again."
    ),
    N_("A score says which explanation is best, not that it is enough."),
    N_("Partly: {rest}; {what}, the numbers do not."),
    N_("the places stand"),
    N_("the place stands"),
    N_("what was found stands"),
    N_(
        "Unknown: {what}; no effect of the library without {name} (left out on request) explains "
        "it."
    ),
    N_(
        "What repeats there takes {rest} of the weighted squared error, by noise alone it "
        "would be less than {limit}."
    ),
    N_("From that moment on the weighted squared error is {number} more than noise makes it."),
    N_("The weighted squared error that is left is {number} more than noise makes it."),
    N_("The shifts of all declared numbers, squared in standard deviations, add up to {number}."),
    N_(
        "On the held-out record the error in {channel} is {before} rms as declared, {after} as "
        "amended; noise alone leaves {floor}."
    ),
    N_(
        "On the record fitted (no proof) the error in {channel} is {before} rms as declared, "
        "{after} as amended; noise alone leaves {floor}."
    ),
    N_(
        "There the error in {channel} is {before} rms as declared, {after} as amended; noise "
        "alone leaves {floor}."
    ),
    N_("As amended, all tensions and speeds are within 10 % of noise."),
    N_("As amended, more than 10 % above noise: {rest}."),
    N_(
        "On the held-out record the error in {channel} is {before} rms as declared; noise alone"
        " leaves {floor}."
    ),
    N_(
        "On the record fitted (no proof) the error in {channel} is {before} rms as declared; "
        "noise alone leaves {floor}."
    ),
    N_("There the error in {channel} is {before} rms as declared; noise alone leaves {floor}."),
    N_("As declared, all tensions and speeds are within 10 % of noise."),
    N_("As declared, more than 10 % above noise: {rest}."),
    N_("Make the record that tells the candidates apart before anything is changed."),
    N_("Paste the AFF block below into the site file."),
    N_(
        "The ripple of a cancelled roller comes back when the service is off; to be rid of it: "
        "{what}."
    ),
    N_(
        "Until that is done, try site_proposed.yaml with `aff-runtime settings try`: it has the "
        "block of {roll}."
    ),
    N_("At the machine: {what}."),
    N_("Also at the machine: {what}."),
    N_("This is no ripple to cancel."),
    N_("For {what}: change nothing before this test: {rest}."),
    N_("Nor paste the AFF block of {roll} before it."),
    N_("Put a dial gauge on {rest} and turn it once by hand: what the gauge shows is the cause."),
    N_("What is left is largest in {rest}: look there."),
    N_("Record again, longer, and at other speeds and tensions."),
    N_("Not explained: {rest}."),
    N_(
        "{number} of {count} declared numbers had to leave their tolerance: the explanation is "
        "incomplete; do not correct them, record again."
    ),
    N_(
        "the records want {rest} from where it is declared, so the cause lies there or imitates it"
    ),
    N_("Look for what turns or swings at that coordinate; the amended line does not contain it."),
    N_(
        "At standstill hang weights on the measuring roller of {channel} one by one and take "
        "them off again: a reading that comes back otherwise sticks."
    ),
    N_(
        "Look for what a clock starts or stops at that period: a task of the PLC, a message on "
        "the bus, a valve, a fan; the amended line does not contain it."
    ),
    N_("Do not take the declaration for right: {rest} above noise on the record judged."),
    N_("Fit that record and judge on the other."),
    N_("Nothing to do: the declaration stands."),
    N_("First at the machine: {what}."),
    N_(
        "Until that is done, paste the AFF block below into the site file, at the actuator of "
        "{roll}."
    ),
    N_("The ripple of a cancelled roller comes back when the service is off."),
    N_("Look in the log of {name} at {number} s: what was done on the line then."),
    N_("Not explained: {rest}: check these."),
    N_(
        "Nothing to do: the declaration stands, except for what these records cannot tell: {rest}."
    ),
    N_(
        "Record at another speed and fit both records: what repeats in time keeps its frequency "
        "there, what turns its length of web or its order."
    ),
    N_("{what} (one speed does not tell which)"),
    N_("{what}, or else {why}"),
    N_("something that repeats in time, {number} Hz at every speed"),
    N_(
        "something that repeats in time, {number} Hz at every speed, strongest in {channel}, in "
        "{zone}"
    ),
    N_("something that repeats in time, {number} Hz"),
    N_(
        "something that comes again every {number} s at every speed, strongest in {channel}, in "
        "{zone}"
    ),
    N_("something that comes again every {number} s"),
    N_(
        "{channel} (and {rest} alike) depends on which way the tension went last, {number} N "
        "apart, while the speeds tell it otherwise: so reads a cell at which something sticks or "
        "has play, and a loop that holds it hunts"
    ),
    N_(
        "{channel} depends on which way the tension went last, {number} N apart, while the speeds "
        "tell it otherwise: so reads a cell at which something sticks or has play, and a loop "
        "that holds it hunts"
    ),
    N_("something that repeats {number} times per turn of {roll}"),
    N_(
        "something that repeats every {number} mm of web ({inverse} 1/m); a roller of {radius} "
        "mm radius turns so"
    ),
    N_(
        "an event at {number} s of {name} in {zone}, first seen in {channel}; ask what was done"
        " on the line then"
    ),
    N_(
        "an event at {number} s in {zone}, first seen in {channel}; ask what was done on the "
        "line then"
    ),
    N_(
        "something irregular that pushes the line: at {band} {thing} do not move together as "
        "the declared noise does; look at the drive and the web between them"
    ),
    N_("noise above the line's own, at no frequency in particular"),
    N_("all load cells"),
)
"""How a verdict puts them together."""

PATTERNS = (*NAMES, *TEXTS, *REMEDIES, *VERDICT)
