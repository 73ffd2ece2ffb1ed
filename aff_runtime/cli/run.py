"""``aff-runtime run SITE.yaml``: the service itself, in the foreground."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from aff_runtime.app.hand.may import ROLES, Place
from aff_runtime.base.errors import ConfigError
from aff_runtime.cli.service import add_state_dir, paths_of


def add(commands: Any, service: argparse.ArgumentParser) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "run", parents=[service], help="run the service; the correction is off until armed"
    )
    parser.add_argument("site", type=Path, metavar="SITE.yaml")
    parser.add_argument("--shadow", action="store_true", help="compute and record, transmit zero")
    parser.add_argument(
        "--record-dir",
        type=Path,
        default=None,
        metavar="DIR",
        help="folder of all records (default: recording.directory of the site file)",
    )
    parser.add_argument(
        "--door-dir",
        type=Path,
        default=None,
        metavar="DIR",
        help="folder of the door for screens of another user, aff-hmi (default: the runtime "
        "directory, for our own user alone)",
    )
    parser.add_argument(
        "--hand",
        choices=tuple(ROLES),
        help="hear a screen, at most so: view (bypass only), operate (arm too), commission "
        "(default: no screen is heard)",
    )
    parser.add_argument(
        "--hand-from",
        choices=tuple(Place),
        default=Place.PANEL,
        help="from where a screen is heard: at the machine, or on its network too (default "
        "panel); a bypass is heard from both",
    )
    parser.add_argument(
        "--hand-dir",
        type=Path,
        default=None,
        metavar="DIR",
        help="folder of the hand's socket for screens of another user, aff-hmi (default: the "
        "runtime directory, for our own user alone)",
    )
    add_state_dir(parser)
    parser.add_argument(
        "--wait",
        action="store_true",
        help="begin once the site file is there and good; a file that is there runs at once",
    )
    parser.add_argument(
        "--forget",
        action="store_true",
        help="another roll was put in: drop the saved shapes of rolls that are exchanged",
    )
    parser.set_defaults(command=run)


def run(options: argparse.Namespace) -> int:
    """Serve until stopped."""
    if options.hand is None and options.hand_dir is not None:
        raise ConfigError("--hand-dir: needs --hand as well: view, operate or commission")
    from aff_runtime.app.supervisor.run_options import RunOptions  # noqa: PLC0415  keeps `arm` quick
    from aff_runtime.app.supervisor.service_log import open_log  # noqa: PLC0415
    from aff_runtime.app.supervisor.supervisor import Supervisor  # noqa: PLC0415

    open_log()
    if options.wait:
        from aff_runtime.app.supervisor.first_file import await_site  # noqa: PLC0415

        await_site(options.site, options.state_dir)
    supervisor = Supervisor(
        RunOptions(
            site=options.site,
            paths=paths_of(options),
            record_directory=options.record_dir,
            state_directory=options.state_dir,
            door_directory=options.door_dir,
            hand=ROLES[options.hand] if options.hand else None,
            hand_from=Place(options.hand_from),
            hand_directory=options.hand_dir,
            shadow=options.shadow,
            forget=options.forget,
        )
    )
    return supervisor.run()
