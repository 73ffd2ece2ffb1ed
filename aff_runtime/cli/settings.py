"""``aff-runtime settings diff | try | keep | undo | history``: other settings, with a way back."""

from __future__ import annotations

import argparse
import hashlib
import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from aff_runtime.app.check.limits import PATIENCE_S
from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.link.settings_answer import SettingsAnswer
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import ConfigError, RefusedError, WireError
from aff_runtime.base.files import replace_text
from aff_runtime.base.ports import Clock
from aff_runtime.cli.service import connect
from aff_runtime.cli.terminal import say
from aff_runtime.config.plain_file import read_plain
from aff_runtime.config.yaml_marks import MAX_BYTES

SAVED_PATIENCE_NS = 10_000_000_000
LOOK_NS = 100_000_000
WHY = "reason, for the history; 8 characters at least"


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
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
    act.add_argument("version", type=int, nargs="?", default=0, metavar="N", help="of the history")
    act.add_argument("--why", required=True, metavar="TEXT", help=WHY)
    act.set_defaults(command=partial(settings, "undo"))
    act = acts.add_parser("history", parents=[service], help="what ran: who, when, why")
    act.add_argument("version", type=int, nargs="?", default=0, metavar="N", help="print its text")
    act.set_defaults(command=partial(settings, "history"))


def settings(word: str, options: argparse.Namespace) -> int:
    """Do one act and print what became of it."""
    text = _text(options.file) if word in ("diff", "try") else ""
    client = connect(options)
    try:
        ask = partial(_ask, client)
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


def _ask(client: ServiceClient, **arguments: Any) -> SettingsAnswer:
    answer = client.ask("settings", timeout_s=PATIENCE_S + 5.0, **arguments)
    try:
        return SettingsAnswer.from_json(answer)
    except (ValueError, KeyError, TypeError, AttributeError):
        raise WireError("the answer cannot be read; is the service of another release?") from None


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
        say("undone; the former settings run")
        return
    save(options.site, answer)
    await_saved(lambda: ask(act="state"), answer.text, MonotonicClock())
    say(f"{'kept' if word == 'keep' else 'undone'}; saved in {options.site}")


def save(site: Path, answer: SettingsAnswer) -> None:
    """Save what the service hands out as its site file, with the rights of whoever runs this.

    The caller names the file: no service tells root where to write.

    Raises
    ------
    ConfigError
        When it is not the service's site file, is another one by now, or may not be written;
        nothing is kept then.
    """
    if os.path.realpath(site) != os.path.realpath(answer.site):
        raise ConfigError(f"{site}: the service runs on {answer.site}; nothing is kept")
    if hashlib.sha256(_raw(site)).hexdigest() != answer.replaces:
        raise ConfigError(f"{site}: somebody has saved it meanwhile; nothing is kept")
    try:
        replace_text(site, answer.text, keep_owner=True)
    except OSError as error:
        raise ConfigError(
            f"{site}: {error.strerror}; nothing is kept. Run the command as who may write it"
        ) from None


def await_saved(state: Callable[[], SettingsAnswer], text: str, clock: Clock) -> None:
    """Wait until the service runs on what was saved.

    Raises
    ------
    RefusedError
        When it does not, or not yet.
    """
    wanted = hashlib.sha256(text.encode("utf-8")).hexdigest()
    end_ns = clock.now_ns() + SAVED_PATIENCE_NS
    while clock.now_ns() < end_ns:
        now = state()
        if now.running == wanted and not now.trying:
            return
        clock.sleep_until_ns(clock.now_ns() + LOOK_NS)
    raise RefusedError("it is saved and does not run yet; see `aff-runtime status`")


def _raw(path: Path) -> bytes:
    try:
        return read_plain(path, MAX_BYTES)
    except (OSError, ValueError) as error:
        said = error.strerror if isinstance(error, OSError) else str(error)
        raise ConfigError(f"{path}:1:1  cannot be read: {said}") from None


def _text(path: Path) -> str:
    try:
        return _raw(path).decode("utf-8")
    except UnicodeDecodeError:
        raise ConfigError(f"{path}:1:1  is not UTF-8 text") from None
