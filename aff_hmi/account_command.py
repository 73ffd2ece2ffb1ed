"""``aff-hmi account add | remove | list``: on the machine only; no page makes an account."""

from __future__ import annotations

import argparse
import getpass
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from aff_runtime.app.hand.accounts import (
    LEAST_CHARACTERS,
    MOST_CHARACTERS,
    PIN_DIGITS,
    Account,
    is_pin,
    read_accounts,
    secret_of,
    with_pin,
    write_accounts,
)
from aff_runtime.app.hand.may import ROLES, Role
from aff_runtime.app.hand.messages import NOBODY, is_account_name
from aff_runtime.base.errors import ConfigError, RefusedError

INSTALLED_ACCOUNTS = Path("/etc/aff-hmi/accounts")


def run(arguments: Sequence[str]) -> int:
    """Do what is asked; return the exit code.

    Raises
    ------
    AffError
        When it cannot be done.
    """
    options = _parser().parse_args(arguments)
    path: Path = options.accounts
    there = {one.name: one for one in read_accounts(path)} if path.exists() else {}
    if options.act == "list":
        for one in there.values():
            _say(f"{one.name}  {one.role.word}{'  PIN' if one.has_pin else ''}")
        return 0
    if options.act == "remove":
        if there.pop(options.name, None) is None:
            raise RefusedError(f"{path}: no account {options.name[:40]!a}; see `account list`")
    else:
        there[options.name] = _new(options.name, options.role, has_pin=options.pin)
    write_accounts(path, there.values())
    _say(f"{path}: {options.act} {options.name}; it holds at once, sessions of it have ended")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="aff-hmi account", description="Accounts of the screen.")
    acts = parser.add_subparsers(required=True, dest="act", metavar="ACT")
    for word, text in (
        ("add", "make an account, or give one another role and password"),
        ("remove", "take one away; its sessions end"),
        ("list", "names and roles"),
    ):
        act = acts.add_parser(word, help=text)
        act.add_argument(
            "--accounts",
            type=Path,
            default=INSTALLED_ACCOUNTS,
            metavar="FILE",
            help="(default %(default)s)",
        )
        if word != "list":
            act.add_argument("name", metavar="NAME")
        if word == "add":
            act.add_argument("--role", choices=tuple(ROLES), required=True)
            act.add_argument(
                "--pin",
                action="store_true",
                help=f"ask for a PIN of {PIN_DIGITS} digits as well: it lets in at the panel, and "
                "at the panel alone (not for role commission, whose password signs)",
            )
    return parser


def _new(name: str, role: str, *, has_pin: bool) -> Account:
    if has_pin and ROLES[role] is Role.COMMISSION:
        raise ConfigError("--pin: not for role commission, whose password signs")
    if name == NOBODY:
        raise ConfigError(f"{NOBODY} is what the audit calls who has not logged in; another name")
    if not is_account_name(name):
        raise ConfigError(
            f"{name[:40]!a}: a name has 1 to 32 of A-Z a-z 0-9 . _ - and begins with a letter or "
            "number"
        )
    password = _password("password")
    if not LEAST_CHARACTERS <= len(password) <= MOST_CHARACTERS:
        raise ConfigError(f"a password has {LEAST_CHARACTERS} to {MOST_CHARACTERS} characters")
    secret = secret_of(password)
    if has_pin:
        pin = _password("PIN")
        if not is_pin(pin):
            raise ConfigError(f"a PIN has {PIN_DIGITS} digits")
        secret = with_pin(secret, pin)
    return Account(name=name, role=ROLES[role], secret=secret)


def _password(what: str) -> str:
    """Return a password: typed twice at a terminal, else the next line of what comes in."""
    if not sys.stdin.isatty():
        return sys.stdin.readline().rstrip("\n")
    password = getpass.getpass(f"{what}: ")
    if getpass.getpass("again: ") != password:
        raise RefusedError("the two are not the same; nothing was changed")
    return password


def _say(line: str) -> None:
    os.write(sys.stdout.fileno(), f"{line}\n".encode())
