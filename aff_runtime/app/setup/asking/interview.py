"""The questions in words, in their order; what is measured between them is asked elsewhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from aff_runtime.app.setup.asking.draft import FURTHER, SECOND_TENSION, Draft
from aff_runtime.app.setup.asking.quantities import (
    UNWIND,
    Quantity,
    angles,
    quantities,
    tension_of,
)
from aff_runtime.app.setup.asking.questions import (
    FIND,
    NONE,
    AnswerError,
    Question,
    bit,
    channel_in,
    channel_or_none,
    number,
    number_of,
    one_of,
    read_name,
    read_text,
    split_bit,
    whole,
    word,
    word_or_none,
)
from aff_runtime.app.setup.words.reading import MOST_WORDS

WIRES = ("modbus_tcp", "modbus_udp", "modbus_rtu", "can_dbc", "canopen_402")
BUSES = ("can_dbc", "canopen_402")
"""Wires whose DBC or EDS files name every signal: nothing is searched there."""
YES_NO = ("yes", "no")
BITS = (
    ("LINE_RUN", "the line runs", True),
    ("AFF_ENABLE_REQUEST", "the PLC lets AFF correct", True),
    ("WEB_INTACT", "no web break", True),
    ("TENSION_VALID", "the tension reading may be used", True),
    ("ESTOP_OK", "no emergency stop", True),
    ("REMOTE", "the line is in remote operation", False),
    ("SPLICE_ACTIVE", "a splice runs", False),
    ("RESET_EDGE", "reset of AFF's fault", False),
)
"""Name, meaning, and whether a correction usually waits for it."""
NEEDED = ("LINE_RUN", "WEB_INTACT", "TENSION_VALID", "ESTOP_OK")
NO_TORQUE = (
    "setup writes site files for a speed reference alone, and a probe finds a drive only behind "
    "one. Let the PLC add the correction to the speed reference behind its ramp; or copy "
    "config/euclid_blocks.yaml, write output: torque_reference there, and limits and correction "
    "in N m (docs/config-reference.md)."
)
Known = Callable[[int], str]


def is_bus(draft: Draft) -> bool:
    """Return whether the PLC is on a bus whose files name every signal."""
    return draft.answers.get("wire") in BUSES


def wire_question() -> Question:
    """Return the first question of all."""
    return Question(
        name="wire",
        text=f"How is the PLC reached? {', '.join(WIRES)}",
        read=one_of(*WIRES),
        default="modbus_tcp",
    )


def wire_questions() -> tuple[Question, ...]:
    """Return what is asked before a PLC on Modbus is spoken to."""
    return (
        Question(name="host", text="Address of the PLC, such as 192.168.7.10", read=read_text),
        Question(name="port", text="Port", read=whole(1, 65535), default="502"),
        Question(name="device_id", text="Unit identifier", read=whole(0, 255), default="1"),
        Question(
            name="first",
            text="First word to look at, as a wire address (the manual's first register is 0)",
            read=whole(0, 65535),
            default="0",
        ),
        Question(
            name="count",
            text="How many words to look at",
            read=whole(1, MOST_WORDS),
            default="100",
        ),
    )


def line_questions() -> tuple[Question, ...]:
    """Return what is asked before quantities are looked for."""
    return (
        Question(name="name", text="Name of the line", read=read_text),
        Question(
            name="second",
            text="Name of a second driven roller to correct, such as swrap_follower; or none",
            read=read_name,
            default=NONE,
        ),
    )


def second_question(second: str) -> Question:
    """Return the question for the channel of the tension behind the second roller."""
    names = {one.channel for one in quantities("")}
    return Question(
        name=SECOND_TENSION,
        text=f"Channel of the web tension behind {second}; refine finds it by its name in the "
        "line file, such as pullroll_tension_N",
        read=channel_in("N", names),
        default=tension_of(second),
    )


def second_tension(draft: Draft) -> str:
    """Return the channel of the tension behind the second roller; empty without one."""
    default = tension_of(draft.second)
    return draft.answers.get(SECOND_TENSION, default) if draft.second else ""


def quantities_of(draft: Draft) -> tuple[Quantity, ...]:
    """Return what is looked for on this line."""
    return quantities(draft.second, second_tension(draft))


def angles_of(draft: Draft) -> tuple[Quantity, ...]:
    """Return the angles that are looked for on this line."""
    return angles(draft.second)


def further_question(draft: Draft, number: int) -> Question:
    """Return the question for the name of one more channel to record; ``number`` from 1."""
    own = (*quantities_of(draft), *angles_of(draft))
    names = {one.channel for one in own} | set(draft.further[: number - 1])
    return Question(
        name=f"{FURTHER}.{number}",
        text="Further channel to record, such as r3_tension_N; refine finds it by its name in the "
        "line file; none ends",
        read=channel_or_none(names),
        default=NONE,
    )


def word_questions(draft: Draft, known: Known) -> tuple[Question, ...]:
    """Return what is asked of words that one cannot tell by looking."""
    rolls = roll_names(draft)
    applied = tuple(
        Question(
            name=f"applied.{roll}",
            text=f"Word with the correction of {roll} that the PLC really adds; or none",
            read=word_or_none(known),
            default=NONE,
        )
        for roll in rolls
    )
    return (
        Question(
            name="roll_id",
            text="Word that counts splices (a new roll); one that stands still where there "
            "is none",
            read=word(known),
        ),
        Question(
            name="echo",
            text="Word with the PLC's copy of our heartbeat (aff_echo); or none",
            read=word_or_none(known),
            default=NONE,
        ),
        *(applied if draft.answers.get("echo", NONE) != NONE else ()),
        Question(
            name="write",
            text=f"First of the {8 + 2 * (len(rolls) - 1)} words that AFF writes, in the order of "
            "docs/technician/gateway-block.md (wire address)",
            read=word(lambda address: _not_ours(draft, address)),
            default="100",
        ),
        Question(
            name="correction_scale",
            text="One count of a correction word, m/s (the PLC's own scale)",
            read=number("m/s", 1e-9, 1.0),
            default="0.00001",
        ),
    )


def _not_ours(draft: Draft, address: int) -> str:
    words = range(address, address + 8 + 2 * (len(roll_names(draft)) - 1))
    for place, owner in sorted(draft.owners.items()):
        if place in words:
            return f"words {words[0]} to {words[-1]} would be written, and {place} is {owner}."
    return ""


def status_questions(known: Known) -> tuple[Question, ...]:
    """Return what is asked of the status word before its bits."""
    return (
        Question(
            name="status.word", text="Word with the status bits of the PLC", read=word(known)
        ),
        Question(
            name="status.order",
            text="Has it AFF's own order of bits (docs/technician/gateway-block.md)? yes, no",
            read=one_of(*YES_NO),
            default="yes",
        ),
    )


def bit_questions(draft: Draft, known: Known) -> tuple[Question, ...]:
    """Return what is asked of each status bit of a PLC with an order of its own.

    ``known`` says why a word cannot hold one, or nothing.
    """
    return tuple(
        Question(
            name=f"bits.{name}",
            text=f"{name}: {meaning}. word.bit such as 20.7, `20.7 inverted`, find, none",
            read=bit(partial(_why_no_bit, draft, known, f"bits.{name}")),
            default=FIND if needed else NONE,
        )
        for name, meaning, needed in BITS
    )


def owned_bits(draft: Draft, name: str) -> dict[tuple[int, int], str]:
    """Return which state has which (word, bit), without the one that ``name`` answers."""
    return {
        split_bit(kept)[:2]: other.removeprefix("bits.")
        for other, kept in draft.answers.items()
        if other.startswith("bits.") and other != name and kept not in (NONE, FIND)
    }


def _why_no_bit(draft: Draft, known: Known, name: str, address: int, place: int) -> str:
    owner = owned_bits(draft, name).get((address, place), "")
    return f"bit {place} of word {address} is {owner} already." if owner else known(address)


def machine_questions(draft: Draft) -> tuple[Question, ...]:
    """Return what is asked of the machine: limits, radii, and the drive where it is known."""
    asked = [
        Question(
            name="speed_max",
            text="Highest speed of normal operation",
            read=number("m/s", 0.0, 25.0),
        ),
        Question(name="tension_max", text="Highest web tension", read=number("N", 0.0, 1e5)),
        Question(name="radius_min", text="Radius of the empty core", read=number("m", 0.005, 3.0)),
        Question(name="radius_max", text="Radius of the full roll", read=number("m", 0.005, 3.0)),
        Question(
            name="output",
            text="Which reference of the drive takes the correction? velocity, torque",
            read=_Output(),
            default="velocity",
        ),
        Question(
            name="limit",
            text="Largest correction that the PLC allows at the unwind",
            read=number("m/s", 0.0, 1.0),
        ),
    ]
    if draft.second:
        asked += _of_second(draft.second)
    asked += [
        Question(
            name="probe",
            text="Amplitude of the probe's excitation, m/s; none: chosen from the noise",
            read=number("m/s", 0.0, 0.1),
            default=NONE,
        )
    ]
    if not is_bus(draft):
        codes = one_of("fc23", "fc3_fc16")
        asked.append(Question(name="function", text="Function codes", read=codes, default="fc23"))
    return tuple(asked)


def _of_second(second: str) -> list[Question]:
    """Return what is asked of the second driven roller."""
    return [
        Question(
            name="second_radius",
            text=f"Radius of {second} (half its diameter)",
            read=number("m", 0.005, 3.0),
        ),
        Question(
            name="limit_second",
            text=f"Largest correction that the PLC allows at {second}",
            read=number("m/s", 0.0, 1.0),
        ),
    ]


@dataclass(frozen=True, slots=True)
class _Output:
    """Takes a reference that setup writes a site file for, and says what to do for the other."""

    choices: tuple[str, ...] = ("velocity", "torque")

    def __call__(self, text: str) -> str:
        """Return the reference."""
        chosen = one_of(*self.choices)(text)
        if chosen == "torque":
            raise AnswerError(NO_TORQUE)
        return chosen


def roll_names(draft: Draft) -> tuple[str, ...]:
    """Return the rolls that are corrected."""
    return (UNWIND, draft.second) if draft.second else (UNWIND,)


def first_number(heartbeat: int) -> Question:
    """Return the question by which wire addresses become the manual's numbers."""
    return Question(
        name="number",
        text=f"Which number has word {heartbeat} (the heartbeat) in the PLC's manual or program?",
        read=lambda text: str(register_style(heartbeat, text) + heartbeat),
        default=str(heartbeat),
    )


def register_style(heartbeat: int, text: str) -> int:
    """Return the number that a manual gives to wire address 0: 0, 1, 40001 or 400001."""
    shown = int(whole(0, 465536)(text))
    style = shown - heartbeat
    if style not in (0, 1, 40001, 400001):
        starts = ", ".join(str(heartbeat + first) for first in (0, 1, 40001, 400001))
        raise AnswerError(f"word {heartbeat} can be {starts} in a manual, not {shown}.")
    return style


def style_of(draft: Draft) -> int:
    """Return the number that the PLC's manual gives to wire address 0."""
    heartbeat = draft.answers["heartbeat"]
    return register_style(int(heartbeat), draft.answers.get("number", heartbeat))


def quantity_value(draft: Draft, name: str, unit: str) -> float:
    """Return an answer as a number in ``unit``."""
    return number_of(draft.answers[name], unit)
