"""What the screen server itself has used; the machine is seen by `aff_runtime.base.machine`."""

from __future__ import annotations

import os
import resource
from dataclasses import dataclass
from pathlib import Path

PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")


@dataclass(frozen=True, slots=True, kw_only=True)
class ServerUsage:
    """The screen server itself: processor time since its start, s; memory, MB."""

    cpu_s: float
    memory_MB: float | None


def server_usage() -> ServerUsage:
    """Return what this process has used."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
    except (OSError, ValueError, IndexError):
        pages = 0
    return ServerUsage(
        cpu_s=round(used.ru_utime + used.ru_stime, 1),
        memory_MB=round(pages * PAGE_BYTES / 1e6, 1) if pages else None,
    )
