"""``aff-runtime settings diff | try | keep | undo | history``: other settings, with a way back."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from aff_runtime.app.commission.settings.saving import asked_of, await_saved, raw, save
from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.link.settings_answer import SettingsAnswer
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.cli.service import connect
from aff_runtime.cli.terminal import say

WHY = "reason, for the history; 8 characters at least"
UNDO_N = "a version of the history; without it the try that runs, else the last one before this"
TEXT_N = "print the text of this version; without it the list of all"
_PLACE = re.compile(r":\d+:\d+  ")  # line and column of a finding


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser; ``service`` has the options by which a service is found."""
    parser = commands.add_parser(
        "settings", help="compare, try, keep, undo settings of the running service"
    )
    acts = parser.add_subparsers(required=True, metavar="ACT")
    for word, text in (
        ("diff", "check a site file; what would change, with units, and when"),
        ("try", "run a site file for a while; the former settings return by themselves"),
    ):
        act = acts.add_parser(word, parents=[service], help=text)
        act.add_argument("file", type=Path, metavar="NEW.yaml")
        act.set_defaults(command=partial(settings, word))
        if word == "try":
            act.add_argument(
                "--seconds", type=float, default=60.0, metavar="S", help="5 to 3600 (default 60)"
            )
            act.add_argument("--why", required=True, metavar="TEXT", help=WHY)
    act = acts.add_parser("keep", parents=[service], help="save what is tried as the site file")
    act.add_argument("site", type=Path, metavar="SITE.yaml", help="of the service")
    act.add_argument("--why", required=True, metavar="TEXT", help=WHY)
    act.set_defaults(command=partial(settings, "keep"))
    act = acts.add_parser("undo", parents=[service], help="end a try, or go back to a version")
    act.add_argument("site", type=Path, metavar="SITE.yaml", help="of the service")
    act.add_argument("version", type=int, nargs="?", default=0, metavar="N", help=UNDO_N)
    act.add_argument("--why", required=True, metavar="TEXT", help=WHY)
    act.set_defaults(command=partial(settings, "undo"))
    act = acts.add_parser("history", parents=[service], help="what ran: who, when, why")
    act.add_argument("version", type=int, nargs="?", default=0, metavar="N", help=TEXT_N)
    act.set_defaults(command=partial(settings, "history"))


def settings(word: str, options: argparse.Namespace) -> int:
    """Do one act and print what became of it."""
    text = _text(options.file) if word in ("diff", "try") else ""
    client = connect(options)
    try:
        ask = partial(_ask, client, options)
        if word == "diff":
            _show(ask(act="diff", text=text))
        elif word == "try":
            _try(ask, text, options)
        elif word == "history":
            _history(ask(act="history", version=options.version), options.version)
        else:
            _keep_or_undo(ask, word, options)
    finally:
        client.close()
    return 0


def _ask(client: ServiceClient, options: argparse.Namespace, **arguments: Any) -> SettingsAnswer:
    try:
        return asked_of(client, **arguments)
    except RefusedError as error:
        if "text" in arguments and _PLACE.search(str(error)):
            refused = RefusedError(f"{error}\nlines and columns are those of {options.file}")
            refused.exit_code = error.exit_code
            raise refused from None
        raise


def _show(answer: SettingsAnswer) -> None:
    for remark in answer.remarks:
        say(f"warning: {remark}")
    for change in answer.changes:
        say(change)
    if not answer.changes:
        say("nothing differs from what runs")


def _try(ask: Callable[..., SettingsAnswer], text: str, options: argparse.Namespace) -> None:
    _show(ask(act="try", text=text, seconds=options.seconds, why=options.why))
    say(
        f"tried for {options.seconds:g} s; `aff-runtime settings keep SITE.yaml --why ...` "
        "keeps it, `... undo ...` ends it"
    )


def _history(answer: SettingsAnswer, number: int) -> None:
    if number and not answer.text:
        raise RefusedError(f"the text of version {number} is not there any more")
    for line in answer.text.splitlines():
        say(line)
    for row in answer.versions if not number else ():
        reason = f": {row.why}" if row.why else ""
        say(f"{row.number:4d}  {row.when}  {row.sha256[:12]}  {row.verb} by {row.who}{reason}")


def _keep_or_undo(
    ask: Callable[..., SettingsAnswer], word: str, options: argparse.Namespace
) -> None:
    asked = {"version": options.version} if word == "undo" else {}
    answer = ask(act=word, why=options.why, **asked)
    if not answer.text:
        ended = "; ".join(answer.remarks)
        say(f"the former settings run; the try ended: {ended}")
        return
    save(options.site, answer)
    runs = await_saved(lambda: ask(act="state"), answer.text, MonotonicClock())
    when = "" if runs else "; it takes effect at the next bypass"
    say(f"{'kept' if word == 'keep' else 'undone'}; saved in {options.site}{when}")


def _text(path: Path) -> str:
    try:
        return raw(path).decode("utf-8")
    except UnicodeDecodeError:
        raise ConfigError(f"{path}:1:1  is not UTF-8 text") from None
