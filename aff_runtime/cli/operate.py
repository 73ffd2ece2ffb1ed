"""``aff-runtime arm | bypass | forget | shadow | stop``: one word to the running service."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from typing import Any

from aff_runtime.app.link.answers import Done
from aff_runtime.app.report.status_answer import StatusAnswer
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.ports import Clock
from aff_runtime.base.signals import State
from aff_runtime.cli.service import connect, status_of
from aff_runtime.cli.terminal import say as say_line

STOP_PATIENCE_S = 15.0
BYPASS_PATIENCE_NS = 5_000_000_000
LOOK_NS = 50_000_000


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the commands to the parser."""
    for word, text in (
        ("arm", "let the correction in; refused while a permissive is missing"),
        ("bypass", "take the correction back now; works in every state"),
        ("stop", "fade to zero and end the service"),
    ):
        parser = commands.add_parser(word, parents=[service], help=text)
        parser.set_defaults(command=partial(say, word))
    parser = commands.add_parser(
        "shadow", parents=[service], help="compute and record without transmitting"
    )
    parser.add_argument("switch", choices=("on", "off"), nargs="?", default="on")
    parser.set_defaults(command=partial(say, "shadow"))
    parser = commands.add_parser(
        "forget", parents=[service], help="another roll was put in: drop what was learned of it"
    )
    parser.add_argument(
        "rolls",
        nargs="*",
        metavar="ROLL",
        help="of the site file, a roller too (default: every roll with resets_on: splice)",
    )
    parser.set_defaults(command=partial(say, "forget"))


def say(word: str, options: argparse.Namespace) -> int:
    """Send one word and print what became of it."""
    client = connect(options)
    try:
        if word == "shadow":
            client.ask("shadow", on=options.switch == "on")
            say_line(f"shadow {options.switch}")
        elif word == "stop":
            client.ask("stop", timeout_s=STOP_PATIENCE_S)
            say_line("stopped")
        elif word == "forget":
            named = {"rolls": options.rolls} if options.rolls else {}
            say_line(Done.from_json(client.ask("forget", **named)).message)
        elif word == "bypass":
            client.ask("bypass")
            say_line(after_bypass(lambda: status_of(client), MonotonicClock()))
        else:
            done = Done.from_json(client.ask(word))
            say_line(done.state or "ok")
    finally:
        client.close()
    return 0


def after_bypass(status: Callable[[], StatusAnswer], clock: Clock) -> str:
    """Return what became of a bypass as the service shows it: off, and nothing goes out.

    Parameters
    ----------
    status : asks the service how it stands.
    clock : how long to wait for the end of the fade.

    Raises
    ------
    RefusedError
        When a correction may still be going out.
    """
    end_ns = clock.now_ns() + BYPASS_PATIENCE_NS
    while True:
        answer = status()
        state = answer.state
        if state == State.BYPASS.name and not _goes_out(answer):
            return "bypassed"
        if answer.control_pid == 0:
            return "nothing goes out: no control process is running; see `aff-runtime status`"
        if clock.now_ns() >= end_ns:
            raise RefusedError(
                f"bypass was asked for, and the service still says {state or 'nothing'} after "
                f"{BYPASS_PATIENCE_NS * 1e-9:.0f} s; take the correction back at the PLC, or with "
                "`systemctl kill -s USR1 --kill-whom=main aff-runtime`"
            )
        clock.sleep_until_ns(clock.now_ns() + LOOK_NS)


def _goes_out(answer: StatusAnswer) -> bool:
    """Return whether a status shows a correction."""
    return answer.live is not None and any(sent.value for sent in answer.live.tick.corrections)
