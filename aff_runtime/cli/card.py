"""``aff-runtime card new | show | step | sign | page | verify``: the commissioning card."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import ConfigError
from aff_runtime.cli.service import add_state_dir, paths_of
from aff_runtime.cli.terminal import complain, say

if TYPE_CHECKING:
    from aff_runtime.app.card.entries import Measured
    from aff_runtime.app.card.work import CardFile
    from aff_runtime.app.commission.paths import Paths

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
    step = _add_step(acts, service)
    sign = acts.add_parser("sign", parents=[service], help="sign what a step has measured")
    sign.add_argument("number", type=int, metavar="N")
    sign.add_argument("--as", required=True, dest="name", metavar="NAME", help="who signs")
    sign.add_argument("--reason", required=True, metavar="TEXT", help=REASON)
    sign.set_defaults(command=_sign)
    page = acts.add_parser("page", parents=[service], help=f"write {PAGE}, to be printed")
    page.add_argument("--out", type=Path, metavar="FILE", help=f"default {PAGE} of the card")
    page.add_argument("--paper", choices=("a4", "letter"), default="a4")
    page.set_defaults(command=_page)
    _add_verify(acts)
    for act in (show, step, sign, page):
        _add_places(act)
    for act in (new, show, step, sign, page):
        add_state_dir(act)


def _add_step(acts: Any, service: argparse.ArgumentParser) -> argparse.ArgumentParser:
    """Add the act that measures; return its parser."""
    step: argparse.ArgumentParser = acts.add_parser(
        "step", parents=[service], help="measure a step"
    )
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
    return step


def _add_verify(acts: Any) -> None:
    verify = acts.add_parser("verify", help="is the card what was written? 5 when it is not")
    verify.add_argument("file", type=Path, metavar="FILE", help="card.jsonl, or its folder")
    verify.add_argument("--newest", default="", metavar="HASH", help="as it stands on the page")
    verify.add_argument(
        "--records",
        action="store_true",
        help="also whether the records still are what was measured",
    )
    verify.set_defaults(command=_verify)


def _add_places(act: argparse.ArgumentParser) -> None:
    """Add where card and site file lie."""
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


def _new(options: argparse.Namespace) -> int:
    from aff_runtime.app.card import work  # noqa: PLC0415 - numpy is for the card alone
    from aff_runtime.app.commission.paths import parameters_of  # noqa: PLC0415

    parameters = parameters_of(options.site, options.state_dir)
    newest = work.begin(options.folder, options.site, parameters)
    say(f"{options.folder}: a card of {parameters.site.line.name}, {newest[:12]}")
    return 0


def _show(options: argparse.Namespace) -> int:
    from aff_runtime.app.card import lines, work  # noqa: PLC0415
    from aff_runtime.app.commission.card import sources  # noqa: PLC0415

    card = work.CardFile.of(options.card)
    now, said = sources.inputs_now(_where(options, card), card)
    for line in said:
        complain(line)
    for line in lines.card_lines(card.card(now)):
        say(line)
    return 0


def _step(options: argparse.Namespace) -> int:
    """Measure; 5 when a limit is not kept."""
    from aff_runtime.app.card import lines, steps, work  # noqa: PLC0415
    from aff_runtime.app.card.typed_values import NotTypedError, typed  # noqa: PLC0415
    from aff_runtime.app.commission.card import sources  # noqa: PLC0415
    from aff_runtime.app.commission.paths import by_whom  # noqa: PLC0415

    card = work.CardFile.of(options.card)
    where = _where(options, card)
    found = sources.sources(where, card, windows=options.run, plc=options.plc)
    by = by_whom()
    if options.not_applicable:
        inputs = sources.inputs_of(found)
        kept: Measured = work.leave_out(card, options.number, options.not_applicable, inputs, by)
    else:
        values = tuple(typed(text) for text in options.typed)
        if options.number == steps.SEARCH:
            found = sources.after_search(where, found, values, say)
        try:
            with bounded_effort("card", ConfigError, seconds=LONGEST_S, memory_bytes=MEMORY_BYTES):
                kept = work.measure(card, options.number, found, values, by)
        except NotTypedError as error:
            raise ConfigError(f"{error}; {lines.HOW_TO_TYPE}") from None
    work.keep_site(options.card, found.parameters)
    for line in lines.measured_lines(kept):
        say(line)
    return EXIT_FAILED if kept.verdict == "fail" else 0


def _sign(options: argparse.Namespace) -> int:
    from aff_runtime.app.card import lines, work  # noqa: PLC0415
    from aff_runtime.app.commission.card import sources  # noqa: PLC0415
    from aff_runtime.app.commission.paths import by_whom  # noqa: PLC0415

    card = work.CardFile.of(options.card)
    now = sources.inputs_of(sources.sources(_where(options, card), card))
    by = by_whom()
    signed = work.sign(card, options.number, now, name=options.name, reason=options.reason, by=by)
    newest = work.CardFile.of(options.card).newest
    say(f"step {signed.step} {lines.signed_line(signed)}; newest {newest}")
    return 0


def _page(options: argparse.Namespace) -> int:
    from aff_runtime.app.card import page, work  # noqa: PLC0415
    from aff_runtime.app.commission.card import sources  # noqa: PLC0415
    from aff_runtime.base.files import replace_text  # noqa: PLC0415

    card = work.CardFile.of(options.card)
    now, said = sources.inputs_now(_where(options, card), card)
    for line in said:
        complain(line)
    out = options.out or options.card / PAGE
    try:
        replace_text(out, page.page(card.card(now), options.paper, said))
    except OSError as error:
        raise ConfigError(f"--out {out}: {error.strerror}") from None
    say(out)
    return 0


def _verify(options: argparse.Namespace) -> int:
    """Follow the chain; 5 when it does not hold."""
    from aff_runtime.app.card.verify import verify  # noqa: PLC0415

    found = verify(options.file, options.newest, records=options.records)
    for text in found.wrong:
        complain(f"aff-runtime: {found.path}: does not hold: {text}")
    if found.wrong:
        return EXIT_BROKEN
    say(f"{found.entries} entries, whole; newest {found.newest}")
    return 0


def _where(options: argparse.Namespace, card: CardFile) -> Paths:
    from aff_runtime.app.commission.paths import Paths  # noqa: PLC0415

    return Paths(
        site=options.site or Path(card.begun.site),
        state=options.state_dir,
        socket=paths_of(options).socket,
        card=options.card,
    )
