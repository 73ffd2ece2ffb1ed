"""``aff-runtime card new | show | step | sign | page | verify``: the commissioning card."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import ConfigError
from aff_runtime.cli.service import add_state_dir
from aff_runtime.cli.terminal import complain, say

if TYPE_CHECKING:
    from aff_runtime.app.card.entries import Measured

EXIT_BROKEN = EXIT_FAILED = 5
PAGE = "card.html"
LONGEST_S = 600.0
MEMORY_BYTES = 4 << 30
REASON = "in 8 characters at least"


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser("card", help="the commissioning card: measure, sign, print")
    acts = parser.add_subparsers(required=True, metavar="ACT")
    new = acts.add_parser("new", help="begin a card of a line")
    new.add_argument("site", type=Path, metavar="SITE.yaml")
    new.add_argument("folder", type=Path, metavar="CARD_DIR", help="made; holds card.jsonl")
    new.set_defaults(command=_new)
    show = acts.add_parser("show", parents=[service], help="how every step stands")
    show.set_defaults(command=_show)
    step = acts.add_parser("step", parents=[service], help="measure a step")
    step.add_argument("number", type=int, metavar="N", help="0 to 12")
    step.add_argument(
        "--run",
        action="append",
        default=[],
        metavar="RUN_DIR@FROM..TO",
        help="where in a record (default: the newest of the running service)",
    )
    step.add_argument(
        "--typed",
        action="append",
        default=[],
        metavar="'NAME=VALUE UNIT'",
        help="what a display shows or a person knows; may be repeated",
    )
    step.add_argument(
        "--plc",
        default="",
        metavar="TEXT",
        help="version of the PLC's program; steps measured on another are due again",
    )
    step.add_argument(
        "--not-applicable",
        default="",
        metavar="WHY",
        help=f"the step is not for this line, and why, {REASON}",
    )
    step.set_defaults(command=_step)
    sign = acts.add_parser("sign", parents=[service], help="sign what a step has measured")
    sign.add_argument("number", type=int, metavar="N")
    sign.add_argument("--as", required=True, dest="name", metavar="NAME", help="who signs")
    sign.add_argument("--reason", required=True, metavar="TEXT", help=REASON)
    sign.set_defaults(command=_sign)
    page = acts.add_parser("page", parents=[service], help=f"write {PAGE}, to be printed")
    page.add_argument("--out", type=Path, metavar="FILE", help=f"default {PAGE} of the card")
    page.add_argument("--paper", choices=("a4", "letter"), default="a4")
    page.set_defaults(command=_page)
    verify = acts.add_parser("verify", help="is the card what was written? 5 when it is not")
    verify.add_argument("file", type=Path, metavar="FILE", help="card.jsonl, or its folder")
    verify.add_argument("--newest", default="", metavar="HASH", help="as it stands on the page")
    verify.add_argument(
        "--records",
        action="store_true",
        help="also whether the records still are what was measured",
    )
    verify.set_defaults(command=_verify)
    for act in (show, step, sign, page):
        act.add_argument(
            "--card",
            type=Path,
            default=Path(),
            metavar="CARD_DIR",
            help="folder of the card (default: here)",
        )
        act.add_argument(
            "--site",
            type=Path,
            metavar="SITE.yaml",
            help="where it lies now (default: as when the card was begun)",
        )
    for act in (new, show, step, sign, page):
        add_state_dir(act)


def _new(options: argparse.Namespace) -> int:
    from aff_runtime.app.card import work  # noqa: PLC0415 - numpy is for the card alone
    from aff_runtime.cli import card_sources  # noqa: PLC0415

    record = card_sources.record_of(options.site, options.state_dir)
    newest = work.begin(options.folder, options.site, record)
    say(f"{options.folder}: a card of {record.site.line.name}, {newest[:12]}")
    return 0


def _show(options: argparse.Namespace) -> int:
    from aff_runtime.app.card import lines, work  # noqa: PLC0415
    from aff_runtime.cli import card_sources  # noqa: PLC0415

    card = work.CardFile.of(options.card)
    now, said = card_sources.inputs_now(options, card)
    for line in said:
        complain(line)
    for line in lines.card_lines(card.card(now)):
        say(line)
    return 0


def _step(options: argparse.Namespace) -> int:
    """Measure; 5 when a limit is not kept."""
    from aff_runtime.app.card import lines, steps, work  # noqa: PLC0415
    from aff_runtime.app.card.typed_values import typed  # noqa: PLC0415
    from aff_runtime.cli import card_sources  # noqa: PLC0415

    card = work.CardFile.of(options.card)
    sources = card_sources.sources(options, card, windows=options.run, plc=options.plc)
    by = card_sources.by_whom()
    if options.not_applicable:
        inputs = card_sources.inputs_of(sources)
        found: Measured = work.leave_out(card, options.number, options.not_applicable, inputs, by)
    else:
        values = tuple(typed(text) for text in options.typed)
        if options.number == steps.SEARCH:
            sources = card_sources.after_search(options, sources, values)
        with bounded_effort("card", ConfigError, seconds=LONGEST_S, memory_bytes=MEMORY_BYTES):
            found = work.measure(card, options.number, sources, values, by)
    work.keep_site(options.card, sources.record)
    for line in lines.measured_lines(found):
        say(line)
    return EXIT_FAILED if found.verdict == "fail" else 0


def _sign(options: argparse.Namespace) -> int:
    from aff_runtime.app.card import work  # noqa: PLC0415
    from aff_runtime.cli import card_sources  # noqa: PLC0415

    card = work.CardFile.of(options.card)
    now = card_sources.inputs_of(card_sources.sources(options, card))
    by = card_sources.by_whom()
    signed = work.sign(card, options.number, now, name=options.name, reason=options.reason, by=by)
    newest = work.CardFile.of(options.card).newest
    say(f"step {signed.step} signed as {signed.name}; newest {newest}")
    return 0


def _page(options: argparse.Namespace) -> int:
    from aff_runtime.app.card import page, work  # noqa: PLC0415
    from aff_runtime.base.files import replace_text  # noqa: PLC0415
    from aff_runtime.cli import card_sources  # noqa: PLC0415

    card = work.CardFile.of(options.card)
    now, said = card_sources.inputs_now(options, card)
    for line in said:
        complain(line)
    out = options.out or options.card / PAGE
    try:
        replace_text(out, page.page(card.card(now), options.paper))
    except OSError as error:
        raise ConfigError(f"--out {out}: {error.strerror}") from None
    say(out)
    return 0


def _verify(options: argparse.Namespace) -> int:
    """Follow the chain; 5 when it does not hold."""
    from aff_runtime.app.card import book, chain, entries, records  # noqa: PLC0415

    path = book.card_file(options.file)
    found = chain.follow(book.content_of(path))
    wrong = [found.wrong] if found.wrong else []
    if not wrong and options.newest and found.newest != options.newest:
        number = next((k.number for k in found.links if k.sha256 == options.newest), 0)
        wrong.append(
            f"the page's hash is that of entry {number}: {len(found.links) - number} were added"
            if number
            else "no entry has the page's hash: entries were taken away, or it is another card"
        )
    if not wrong and options.records:
        said = [one.said for one in entries.entries_of(found)]
        measured = [one for one in said if isinstance(one, entries.Measured)]
        wrong = [text for one in measured for w in one.windows for text in records.differences(w)]
    for text in wrong:
        complain(f"aff-runtime: {path}: does not hold: {text}")
    if wrong:
        return EXIT_BROKEN
    say(f"{len(found.links)} entries, whole; newest {found.newest}")
    return 0
