"""``aff-runtime commission``: let a screen commission; sends no correction."""

from __future__ import annotations

import argparse
import asyncio
import signal
from pathlib import Path
from typing import Any

from aff_runtime.app.hand.may import Place
from aff_runtime.cli.service import add_state_dir, paths_of
from aff_runtime.cli.terminal import say


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "commission",
        parents=[service],
        help="let a screen find words, write the site file, measure and sign the card",
    )
    parser.add_argument("site", type=Path, metavar="SITE.yaml", help="may not be there yet")
    parser.add_argument(
        "--card", type=Path, required=True, metavar="CARD_DIR", help="folder of the card"
    )
    parser.add_argument(
        "--accounts",
        type=Path,
        required=True,
        metavar="FILE",
        help="of the screen, made by `aff-hmi account add`; passwords are checked here",
    )
    parser.add_argument(
        "--from",
        dest="farthest",
        choices=tuple(Place),
        default=Place.PANEL,
        help="where a screen may commission: at the machine, or its network too (default panel)",
    )
    parser.add_argument(
        "--dir",
        type=Path,
        metavar="DIR",
        help="folder of the socket for screens of another user, aff-hmi (default: the runtime "
        "directory, for our own user alone)",
    )
    _add_of_runs(parser)
    add_state_dir(parser)
    parser.set_defaults(command=commission)


def _add_of_runs(parser: argparse.ArgumentParser) -> None:
    """Add where recorded runs are, and what is made of them."""
    parser.add_argument(
        "--record-dir",
        type=Path,
        metavar="DIR",
        help="folder of all records, as of the service (default: recording.directory of the "
        "site file)",
    )
    parser.add_argument(
        "--line",
        type=Path,
        metavar="LINE.yaml",
        help="declaration of the line, for `sim-plant refine` from the screen",
    )
    parser.add_argument(
        "--watch",
        type=Path,
        metavar="STORE",
        help="store of `aff-runtime watch`, for the screen's maintenance page (default: one in "
        "the service's state)",
    )


def commission(options: argparse.Namespace) -> int:
    """Serve until ended."""
    from aff_runtime.app.commission.paths import Paths  # noqa: PLC0415
    from aff_runtime.app.commission.serving.commissioner import Commissioner  # noqa: PLC0415 - numpy
    from aff_runtime.app.hand.accounts import Accounts, read_accounts  # noqa: PLC0415
    from aff_runtime.app.hand.audit import Audit  # noqa: PLC0415
    from aff_runtime.app.link.runtime_directory import make_private  # noqa: PLC0415
    from aff_runtime.app.supervisor.service_log import open_log  # noqa: PLC0415
    from aff_runtime.app.supervisor.settings.history import kept_folder  # noqa: PLC0415
    from aff_runtime.base.clock import MonotonicClock  # noqa: PLC0415

    read_accounts(options.accounts)
    open_log()
    paths = paths_of(options)
    if options.dir is None:
        make_private(paths.directory)
    where = Paths(
        site=options.site.absolute(),
        state=options.state_dir,
        socket=paths.socket,
        card=options.card.absolute(),
        line=None if options.line is None else options.line.absolute(),
        runs=None if options.record_dir is None else options.record_dir.absolute(),
        watch=None if options.watch is None else options.watch.absolute(),
    )
    audit = Audit(kept_folder(where.site, where.state, "commissioning"))
    accounts, farthest = Accounts(options.accounts), Place(options.farthest)
    commissioner = Commissioner(where, accounts, audit, MonotonicClock(), farthest)
    try:
        asyncio.run(_serve(commissioner, options.dir or paths.directory, options.dir is None))
    finally:
        commissioner.close()
    return 0


async def _serve(commissioner: Any, folder: Path, is_private: bool) -> None:
    """Listen until a signal."""
    from aff_runtime.app.commission.link.listening import Listener  # noqa: PLC0415

    listener = Listener(folder, commissioner.answer, is_private=is_private)
    loop = asyncio.get_running_loop()
    ended = asyncio.Event()
    for one in (signal.SIGTERM, signal.SIGINT):
        loop.add_signal_handler(one, ended.set)
    tasks = [
        asyncio.create_task(part)
        for part in (listener.run(), commissioner.run(), commissioner.looking.run(), _until(ended))
    ]
    say("ready; a screen with --commission-socket finds it")
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        for ended_task in done:
            ended_task.result()
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        listener.close()


async def _until(ended: asyncio.Event) -> None:
    await ended.wait()
