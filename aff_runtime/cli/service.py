"""The connection from a command to the running service."""

from __future__ import annotations

import argparse
from pathlib import Path

from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.link.runtime_directory import RuntimePaths, default_directory, runtime_paths
from aff_runtime.app.report.status_answer import StatusAnswer, read_answer
from aff_runtime.config.site_paths import STATE_DIRECTORY


def paths_of(options: argparse.Namespace) -> RuntimePaths:
    """Return the service's paths by ``--runtime-dir`` or the default."""
    return runtime_paths(options.runtime_dir or default_directory())


def add_state_dir(parser: argparse.ArgumentParser) -> None:
    """Add the option that names the folder of what the service learns."""
    parser.add_argument(
        "--state-dir",
        type=Path,
        default=STATE_DIRECTORY,
        metavar="DIR",
        help="folder beside the site file's own that what it names may lie in "
        "(default %(default)s)",
    )


def status_of(client: ServiceClient) -> StatusAnswer:
    """Return how the service stands."""
    return read_answer(client.ask("status"))


def connect(options: argparse.Namespace) -> ServiceClient:
    """Return a connection to the running service.

    Raises
    ------
    WireError
        When there is none.
    """
    return ServiceClient(paths_of(options).socket)
