"""Waits for a first site file: a gateway is installed before anybody has commissioned its line."""

from __future__ import annotations

import logging
from pathlib import Path

from aff_runtime.app.supervisor.file_watch import FileWatch
from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.ports import Clock

LOOK_NS = 200_000_000  # between two looks at the file
LOG = logging.getLogger("aff_runtime")


def await_site(site: Path, state: Path, clock: Clock | None = None) -> None:
    """Return once a site file is there and good.

    A file with faults is logged once, and checked again when it has changed.

    Parameters
    ----------
    state : second folder that named files may lie in.
    """
    clock = clock or MonotonicClock()
    if not site.exists():
        LOG.info("%s: not there yet; the service begins once it is", site)
    while True:
        while not site.exists():
            clock.sleep_until_ns(clock.now_ns() + LOOK_NS)
        watch = FileWatch([site])
        try:
            load_parameters(site, state)
        except ConfigError as error:
            LOG.error("the service waits for a good site file: %s", error)
        else:
            return
        while site.exists() and not watch.changed():
            clock.sleep_until_ns(clock.now_ns() + LOOK_NS)
