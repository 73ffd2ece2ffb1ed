"""The connection from a command to the running service."""

from __future__ import annotations

import argparse

from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.link.runtime_directory import RuntimePaths, default_directory, runtime_paths


def paths_of(options: argparse.Namespace) -> RuntimePaths:
    """Return the service's paths by ``--runtime-dir`` or the default."""
    return runtime_paths(options.runtime_dir or default_directory())


def connect(options: argparse.Namespace) -> ServiceClient:
    """Return a connection to the running service.

    Raises
    ------
    WireError
        When there is none.
    """
    return ServiceClient(paths_of(options).socket)
