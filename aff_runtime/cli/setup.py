"""``aff-runtime setup SITE.yaml``: from a PLC's words to a checked site file; writes no word."""

from __future__ import annotations

import argparse
import sys
from functools import partial
from pathlib import Path
from typing import Any

from aff_runtime.app.setup.draft import Draft, read_draft
from aff_runtime.app.setup.interview import (
    BITS,
    YES_NO,
    bit_questions,
    drive_questions,
    first_number,
    line_questions,
    machine_questions,
    status_questions,
    wire_questions,
    word_questions,
)
from aff_runtime.app.setup.plc import instead_of, polled, reader_of
from aff_runtime.app.setup.quantities import angles, quantities
from aff_runtime.app.setup.questions import NONE, Question, one_of
from aff_runtime.app.setup.site_text import site_text
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.files import replace_text
from aff_runtime.cli.check import check
from aff_runtime.cli.service import add_state_dir
from aff_runtime.cli.setup_dialogue import Dialogue, LeftError, Script
from aff_runtime.cli.setup_steps import Steps
from aff_runtime.cli.terminal import complain, say
from aff_runtime.fieldbus.modbus.registers import MAX_READ_WORDS

_NOBODY = (
    "setup asks at a terminal, and there is none. Give the answers in a file: --answers FILE.yaml "
    "(docs/technician/setup.md says how)."
)


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "setup", help="find a PLC's words and write the site file; writes no word to the PLC"
    )
    parser.add_argument("site", type=Path, metavar="SITE.yaml", help="file to write")
    parser.add_argument(
        "--answers", type=Path, metavar="FILE.yaml", help="answers by the names of the questions"
    )
    parser.add_argument(
        "--again",
        action="append",
        default=[],
        metavar="NAME",
        help="forget a kept answer or quantity and ask it again; may be repeated",
    )
    add_state_dir(parser)
    parser.set_defaults(command=setup)


def setup(options: argparse.Namespace) -> int:
    """Ask, look, write, check; 0 when the file may be used, or when the technician leaves."""
    if options.answers is None and not sys.stdin.isatty():
        raise ConfigError(_NOBODY)
    kept_in = options.site.with_suffix(".setup.json")
    draft = read_draft(kept_in)
    for name in options.again:
        draft = draft.without(name)
    script = Script(options.answers) if options.answers is not None else None
    dialogue = Dialogue(draft, kept_in, script)
    say("q or ctrl-d leaves at any question; what was answered is kept. No word is written.")
    try:
        _interview(dialogue)
        if not _write(dialogue, options.site):
            return 0
    except LeftError:
        say(f"left; what was answered is in {kept_in}. The same command goes on from there.")
        return 0
    for line in script.left_over(dialogue.draft) if script is not None else ():
        complain(line)
    checked = argparse.Namespace(
        site=options.site, speed=[], brief=True, state_dir=options.state_dir
    )
    return check(checked)


def _interview(dialogue: Dialogue) -> None:
    """Ask and look until everything is known."""
    for question in wire_questions():
        kind = dialogue.ask(question)
        if instead_of(kind):
            dialogue.keep(dialogue.draft.without("wire"))
            raise ConfigError(instead_of(kind))
    reader = reader_of(dialogue.draft, MonotonicClock())
    try:
        _look(dialogue, Steps(dialogue, reader))
    finally:
        reader.close()


def _look(dialogue: Dialogue, steps: Steps) -> None:
    steps.survey()
    steps.heartbeat()
    dialogue.ask(first_number(int(dialogue.draft.answers["heartbeat"])))
    for question in line_questions():
        dialogue.ask(question)
    second = dialogue.draft.answers["second"]
    second = "" if second == NONE else second
    for quantity in quantities(second):
        steps.quantity(quantity)
    for question in machine_questions(dialogue.draft):
        dialogue.ask(question)
    for quantity in angles(second):
        steps.angle(quantity)
    for question in status_questions(partial(_why_not, dialogue, "status.word")):
        dialogue.ask(question)
    if dialogue.draft.answers["status.order"] == "no":
        for number in range(len(BITS)):  # each knows the places of those before it
            known = partial(_why_no_bits, dialogue)
            steps.find_bit(bit_questions(dialogue.draft, known)[number])
    _words(dialogue)
    if dialogue.draft.answers["law"] == "shape":
        for question in drive_questions():
            dialogue.ask(question)
    block = polled(dialogue.draft)
    if block.count <= MAX_READ_WORDS and not steps.fits_one_read(block):
        complain(
            f"warning  the PLC refuses words {block.start} to {block.start + block.count - 1} in "
            "one request, and AFF polls one block. Let the PLC put them together."
        )


def _words(dialogue: Dialogue) -> None:
    """Ask for words that looking does not tell; what is asked depends on earlier answers."""
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
    """Return why a word cannot be this, or nothing."""
    first, count = (int(dialogue.draft.answers[key]) for key in ("first", "count"))
    owner = dialogue.draft.owners.get(address, name)
    if owner != name:
        return f"word {address} is {owner} already."
    if not first <= address < first + count:
        return f"word {address} is outside the window {first} to {first + count - 1}."
    return ""


def _why_no_bits(dialogue: Dialogue, address: int) -> str:
    """Return why a word can hold no status bits, or nothing."""
    owner = dialogue.draft.owners.get(address, "")
    name = owner if owner.startswith("bits.") or owner == "status.word" else "status.word"
    return _why_not(dialogue, name, address)


def _write(dialogue: Dialogue, site: Path) -> bool:
    """Write the site file; False when one that is there shall stay."""
    text = _text(dialogue.draft, site)
    if site.exists():
        question = Question(
            name="replace",
            text=f"{site} is there already. Replace it? yes, no",
            read=one_of(*YES_NO),
            default="no",
        )
        if dialogue.ask_anew(question) != "yes":
            say(f"{site} stays as it is; what was answered is in {dialogue.path}")
            return False
    try:
        replace_text(site, text)
    except OSError as error:
        raise ConfigError(f"{site}: cannot be written: {error.strerror}") from error
    say(f"wrote {site}")
    return True


def _text(draft: Draft, site: Path) -> str:
    return site_text(draft, file=site.stem)
