"""``aff-runtime arm | bypass | forget | shadow | stop``: one word to the running service."""

from __future__ import annotations

import argparse
from functools import partial
from typing import Any

from aff_runtime.cli.service import connect

STOP_PATIENCE_S = 15.0
DONE = {"bypass": "bypassed", "forget": "forgotten; rollers are kept"}


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the commands to the parser."""
    for word, text in (
        ("arm", "let the correction in; refused while a permissive is missing"),
        ("bypass", "take the correction back now; works in every state"),
        ("forget", "another roll was put in: drop what was learned of rolls that are exchanged"),
        ("stop", "fade to zero and end the service"),
    ):
        parser = commands.add_parser(word, parents=[service], help=text)
        parser.set_defaults(command=partial(say, word))
    parser = commands.add_parser(
        "shadow", parents=[service], help="compute and record without transmitting"
    )
    parser.add_argument("switch", choices=("on", "off"), nargs="?", default="on")
    parser.set_defaults(command=partial(say, "shadow"))


def say(word: str, options: argparse.Namespace) -> int:
    """Send one word and print what became of it."""
    client = connect(options)
    try:
        if word == "shadow":
            client.ask("shadow", on=options.switch == "on")
            print(f"shadow {options.switch}")
        elif word == "stop":
            client.ask("stop", timeout_s=STOP_PATIENCE_S)
            print("stopped")
        else:
            answer = client.ask(word)
            print(answer.get("state", DONE.get(word, "ok")))
    finally:
        client.close()
    return 0
