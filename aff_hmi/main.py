"""``aff-hmi``: the screen. Exit codes: 0 ok, 2 configuration, 3 the address is taken."""

from __future__ import annotations

import argparse
import asyncio
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from aff_hmi import account_command
from aff_hmi.account_command import INSTALLED_ACCOUNTS
from aff_hmi.entrance import bound
from aff_hmi.listening import PORT, Listening, listening
from aff_hmi.words import LANGUAGES
from aff_runtime.app.hand.accounts import read_accounts
from aff_runtime.app.hand.may import Place
from aff_runtime.app.link.runtime_directory import default_directory, runtime_paths
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import AffError, ConfigError
from aff_runtime.base.printable import printable
from aff_runtime.base.release import release_text
from aff_runtime.loop.watchdog import ServiceNotifier

INSTALLED_DOOR = Path("/run/aff-door/door.sock")
FRAMES_PER_NOTE = 4  # of a living screen, to the service manager


def build_parser() -> argparse.ArgumentParser:
    """Return the parser."""
    parser = argparse.ArgumentParser(
        prog="aff-hmi",
        description="The screen of AFF Runtime, for looking only unless it is given a hand.",
        epilog="aff-hmi account add|remove|list: who may log in",
    )
    parser.add_argument("--version", action="version", version=f"%(prog)s {release_text()}")
    parser.add_argument(
        "--door",
        type=Path,
        default=default_door(),
        metavar="SOCKET",
        help="door of the service (default %(default)s)",
    )
    _add_address(parser)
    _add_hand(parser)
    parser.add_argument(
        "--state",
        type=Path,
        default=os.environ.get("STATE_DIRECTORY") or None,
        metavar="FOLDER",
        help="keep events and trends there, up to 200 MB (default: $STATE_DIRECTORY, else in "
        "memory until the screen ends)",
    )
    parser.add_argument("--language", choices=LANGUAGES, default="en", help="where none is asked")
    return parser


def _add_address(parser: argparse.ArgumentParser) -> None:
    """Add where the screen is reached, and by whom."""
    parser.add_argument(
        "--listen",
        default=f"127.0.0.1:{PORT}",
        metavar="ADDRESS:PORT",
        help="one of this machine; without TLS it must be loopback, which stays open beside any "
        "other (default %(default)s)",
    )
    parser.add_argument(
        "--host",
        action="append",
        default=[],
        metavar="NAME[:PORT]",
        help="a name that browsers use for this screen; may be given again",
    )
    for option, text in (
        ("--certificate", "certificate with its chain, PEM"),
        ("--private-key", "its key, PEM"),
        ("--client-ca", "let in only browsers with a certificate of this authority, PEM"),
    ):
        parser.add_argument(option, type=Path, metavar="FILE", help=text)


def _add_hand(parser: argparse.ArgumentParser) -> None:
    """Add what a screen may do beside looking, and who."""
    parser.add_argument(
        "--hand-socket",
        type=Path,
        metavar="SOCKET",
        help="let those who log in bypass and arm, at a service that runs with --hand (default: "
        "for looking only)",
    )
    parser.add_argument(
        "--commission-socket",
        type=Path,
        metavar="SOCKET",
        help="let those of role commission do so, at an `aff-runtime commission` (needs "
        "--hand-socket)",
    )
    parser.add_argument(
        "--accounts",
        type=Path,
        default=INSTALLED_ACCOUNTS,
        metavar="FILE",
        help="who may log in, made by `aff-hmi account add` (default %(default)s)",
    )
    parser.add_argument(
        "--bypass-from",
        choices=("login", *(place.value for place in Place)),
        default=Place.PANEL.value,
        help="who may bypass without a login: nobody, who is at the machine itself, or everybody "
        "who reaches the address (default %(default)s)",
    )


def default_door() -> Path:
    """Return the door of the installed service where there is one, else of our own user's."""
    if os.path.lexists(INSTALLED_DOOR):
        return INSTALLED_DOOR
    return runtime_paths(default_directory()).door


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the screen; return the exit code."""
    given = sys.argv[1:] if arguments is None else arguments
    try:
        if given[:1] == ["account"]:
            return account_command.run(given[1:])
        options = build_parser().parse_args(given)
        place = listening(
            options.listen,
            tuple(options.host),
            options.certificate,
            options.private_key,
            options.client_ca,
        )
        for one in place.bound_to:  # what cannot be had is told before anything is started
            bound(*one).close()
        if options.hand_socket is not None:
            read_accounts(options.accounts)
        elif options.commission_socket is not None:
            raise ConfigError("--commission-socket: needs --hand-socket as well")
        return _run(options, place)
    except AffError as error:
        _say(f"aff-hmi: {error}", sys.stderr.fileno())
        return error.exit_code
    except KeyboardInterrupt:
        return 0


def _run(options: argparse.Namespace, place: Listening) -> int:
    try:
        from aff_hmi.server import serve  # noqa: PLC0415  heavy, and `--help` is quick without it
    except ImportError as error:
        raise ConfigError(f"{error.name} is needed: install aff-runtime[hmi]") from None
    from aff_hmi.commission.link import Commission  # noqa: PLC0415
    from aff_hmi.hand import Hand  # noqa: PLC0415
    from aff_hmi.see.kept import Kept  # noqa: PLC0415
    from aff_hmi.watch import Watch  # noqa: PLC0415

    clock = MonotonicClock()
    watch = Watch(options.door, clock)
    free = Place(options.bypass_from) if options.bypass_from != "login" else None
    hand = None
    if options.hand_socket:
        hand = Hand(options.hand_socket, options.accounts, clock, bypass_from=free)
    kept = Kept(options.state, clock, can_be_seen=hand is not None)
    commission = Commission(options.commission_socket) if options.commission_socket else None
    notifier = ServiceNotifier(os.environ, every_ticks=FRAMES_PER_NOTE)

    def ready() -> None:
        _say(f"look: {' or '.join(place.urls)}", sys.stdout.fileno())
        notifier.tick_done(True)

    def alive() -> None:
        notifier.tick_done(False)

    try:
        asyncio.run(serve(watch, hand, kept, commission, place, options.language, ready, alive))
    finally:
        watch.close()
        if hand is not None:
            hand.close()  # what it says last is history too
        kept.close()
        notifier.close()
    return 0


def _say(line: str, descriptor: int) -> None:
    os.write(descriptor, f"{printable(line)}\n".encode())


if __name__ == "__main__":
    sys.exit(main())
