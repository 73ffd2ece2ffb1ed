"""What every bench takes its processes from: one killed or hanging costs its job a repeat.

The campaign comes here too. Its rule to know the product by the command line alone is about what
is under test there, and who gives work out says nothing of a line.
"""

from __future__ import annotations

import argparse

from sim_plant.base.worker_pool import LostJobError, WorkerPool
from sim_plant.fleet.cluster import Cluster

__all__ = ["Cluster", "LostJobError", "WorkerPool", "add_workers"]


def add_workers(parser: argparse.ArgumentParser) -> None:
    """Add the options that say who does the work."""
    parser.add_argument("--workers", type=int, default=2, help="of a cluster made here")
    parser.add_argument(
        "--scheduler",
        default="",
        metavar="tcp://HOST:PORT",
        help="the Dask scheduler of a cluster that runs; default: one made on this machine",
    )
