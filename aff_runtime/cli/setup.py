"""``aff-runtime setup SITE.yaml``: from a PLC's words or signals to a checked site file."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from aff_runtime.app.setup.asking.dialogue import Dialogue, LeftError
from aff_runtime.app.setup.asking.draft import Draft, read_draft
from aff_runtime.app.setup.asking.questions import AnswerError
from aff_runtime.app.setup.bus.files import read_file
from aff_runtime.app.setup.bus.questions import EDS
from aff_runtime.app.setup.flow import content_of, interview, write
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.printable import printable
from aff_runtime.base.suggest import meant
from aff_runtime.cli.check import check
from aff_runtime.cli.service import add_state_dir
from aff_runtime.cli.setup_dialogue import Script, Terminal
from aff_runtime.cli.terminal import complain, say

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
    files = parser.add_mutually_exclusive_group()
    files.add_argument(
        "--dbc", metavar="FILE", help="PLC on CAN: begin from this DBC file, beside the site file"
    )
    files.add_argument(
        "--eds",
        action="append",
        default=[],
        metavar="FILE",
        help="PLC and drives on CANopen: begin from this EDS file; may be repeated",
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
        draft = _asked_again(draft, name, kept_in)
    draft = _begun_from(draft, options, kept_in.absolute().parent)
    script = Script(options.answers) if options.answers is not None else None
    dialogue = Dialogue(draft, kept_in, script or Terminal())
    before = content_of(options.site)
    say("q or ctrl-d leaves at any question; what was answered is kept. No word is written.")
    try:
        interview(dialogue)
        if not write(dialogue, options.site, before):
            return 0
    except LeftError:
        say(f"left; what was answered is in {kept_in}. The same command goes on from there.")
        return 0
    for line in script.left_over(dialogue.draft) if script is not None else ():
        complain(line)
    checked = argparse.Namespace(
        site=options.site, speed=[], brief=True, state_dir=options.state_dir
    )
    if code := check(checked):
        return code
    say(
        f"next: understand the warnings, then `aff-runtime run {options.site}`, probe and arm "
        "(docs/technician/first-run.md)"
    )
    return 0


def _begun_from(draft: Draft, options: argparse.Namespace, folder: Path) -> Draft:
    """Return what is kept with the files of the command line as answers."""
    given = {"dbc": options.dbc} if options.dbc else {}
    given |= {f"{EDS}.{number}": name for number, name in enumerate(options.eds, 1)}
    if not given:
        return draft
    answers = {"wire": "can_dbc" if options.dbc else "canopen_402"}
    for name, text in given.items():
        try:
            answers[name] = read_file(folder, text)
        except AnswerError as error:
            raise ConfigError(f"--{name.partition('.')[0]}: {error}") from None
    for name, answer in answers.items():
        if draft.answers.get(name) != answer:
            draft = draft.without(name).with_answer(name, answer)
    return draft


def _asked_again(draft: Draft, name: str, kept_in: Path) -> Draft:
    """Return what is kept without one name; refuses one that hangs on nothing kept."""
    less = draft.without(name)
    if less == draft:
        kept = [*draft.answers, *draft.words]
        raise ConfigError(
            f"--again {printable(name, 40)}: nothing of that name is kept in {kept_in}. "
            f"{meant(name, kept) if kept else 'Nothing is kept there yet.'}"
        )
    return less
