"""The order of `setup`: what is asked, what is looked for, and the site file that comes of it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from aff_runtime.app.setup.asking.dialogue import Dialogue
from aff_runtime.app.setup.asking.draft import Draft
from aff_runtime.app.setup.asking.interview import (
    BITS,
    YES_NO,
    bit_questions,
    first_number,
    is_bus,
    status_questions,
    wire_question,
    wire_questions,
    word_questions,
)
from aff_runtime.app.setup.asking.on_every_wire import ask_drive, ask_line
from aff_runtime.app.setup.asking.plc import instead_of, polled, reader_of
from aff_runtime.app.setup.asking.questions import Question, one_of
from aff_runtime.app.setup.bus.flow import bus_interview
from aff_runtime.app.setup.modbus.steps import Steps
from aff_runtime.app.setup.text.site_text import site_text
from aff_runtime.app.setup.words.reading import WordReader
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.base.files import replace_text
from aff_runtime.config.plain_file import read_plain
from aff_runtime.config.yaml_marks import MAX_BYTES
from aff_runtime.fieldbus.modbus.registers import MAX_READ_WORDS

Reach = Callable[[Draft], WordReader]


def interview(dialogue: Dialogue, reach: Reach | None = None) -> None:
    """Ask and look until everything is known.

    Parameters
    ----------
    reach : makes the reader of the PLC that the answers name; None: one on a socket of its own.

    Raises
    ------
    LeftError
        The technician leaves.
    AffError
        It cannot go on; what was found is kept.
    """
    kind = dialogue.ask(wire_question())
    if instead_of(kind):
        dialogue.keep(dialogue.draft.without("wire"))
        raise ConfigError(instead_of(kind))
    if is_bus(dialogue.draft):
        bus_interview(dialogue)
        return
    for question in wire_questions():
        dialogue.ask(question)
    reader = (reach or _on_its_wire)(dialogue.draft)
    try:
        _look(dialogue, Steps(dialogue, reader))
    finally:
        reader.close()


def _on_its_wire(draft: Draft) -> WordReader:
    return reader_of(draft, MonotonicClock())


def _look(dialogue: Dialogue, steps: Steps) -> None:
    steps.survey()
    steps.heartbeat()
    dialogue.ask(first_number(int(dialogue.draft.answers["heartbeat"])))
    ask_line(dialogue, steps.quantity, steps.angle)
    for question in status_questions(partial(_why_not, dialogue, "status.word")):
        dialogue.ask(question)
    if dialogue.draft.answers["status.order"] == "no":
        for number in range(len(BITS)):  # each knows the places of those before it
            known = partial(_why_no_bits, dialogue)
            steps.find_bit(bit_questions(dialogue.draft, known)[number])
    _words(dialogue)
    if dialogue.draft.answers["law"] == "shape":
        ask_drive(dialogue)
    block = polled(dialogue.draft)
    if block.count <= MAX_READ_WORDS and not steps.fits_one_read(block):
        dialogue.complain(
            f"warning  the PLC refuses words {block.start} to {block.start + block.count - 1} in "
            "one request, and AFF polls one block. Let the PLC put them together."
        )


def _words(dialogue: Dialogue) -> None:
    """Ask for words that cannot be found by looking; what is asked depends on earlier answers."""
    asked: set[str] = set()
    while True:
        known = {
            question.name: question
            for question in word_questions(dialogue.draft, lambda address: "")
            if question.name not in asked
        }
        if not known:
            return
        name = next(iter(known))
        rows = word_questions(dialogue.draft, partial(_why_not, dialogue, name))
        dialogue.ask(next(row for row in rows if row.name == name))
        asked.add(name)


def _why_not(dialogue: Dialogue, name: str, address: int) -> str:
    """Return why a word cannot be what ``name`` asks for; empty where it can."""
    first, count = (int(dialogue.draft.answers[key]) for key in ("first", "count"))
    owner = dialogue.draft.owners.get(address, name)
    if owner != name:
        return f"word {address} is {owner} already."
    if not first <= address < first + count:
        return f"word {address} is outside the window {first} to {first + count - 1}."
    return ""


def _why_no_bits(dialogue: Dialogue, address: int) -> str:
    """Return why a word can hold no status bits; empty where it can."""
    owner = dialogue.draft.owners.get(address, "")
    name = owner if owner.startswith("bits.") or owner == "status.word" else "status.word"
    return _why_not(dialogue, name, address)


def content_of(site: Path) -> bytes | None:
    """Return what a site file holds; None where there is none, or none that can be read."""
    try:
        return read_plain(site, MAX_BYTES)
    except (OSError, ValueError):
        return None


def write(dialogue: Dialogue, site: Path, before: bytes | None) -> bool:
    """Write the site file; False when one that is there shall stay.

    Parameters
    ----------
    before : what it held when the interview began.

    Raises
    ------
    RefusedError
        Somebody has saved it meanwhile; nothing is written.
    """
    text = site_text(dialogue.draft, file=site.stem)
    if site.exists():
        question = Question(
            name="replace",
            text=f"{site} is there already. Replace it? yes, no",
            read=one_of(*YES_NO),
            default="no",
        )
        if dialogue.ask_anew(question) != "yes":
            dialogue.say(f"{site} stays as it is; what was answered is in {dialogue.path}")
            return False
    if content_of(site) != before:
        raise RefusedError(
            f"{site}: somebody has saved it meanwhile; look at it, then begin again. What was "
            f"answered is in {dialogue.path}"
        )
    try:
        replace_text(site, text)
    except OSError as error:
        raise ConfigError(f"{site}: cannot be written: {error.strerror}") from error
    dialogue.say(f"wrote {site}")
    return True
