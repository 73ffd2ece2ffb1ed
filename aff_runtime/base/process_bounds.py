"""What a process of ours that works for others may take of the machine."""

from __future__ import annotations

import contextlib
import resource
from collections.abc import Mapping
from pathlib import Path


def bound_process(limits: Mapping[int, int], oom_score: int) -> None:
    """Bound this process; a hard limit that is lower already stays, and it leaves no core.

    Parameters
    ----------
    limits : by the kind of resource (``resource.RLIMIT_...``), in its unit.
    oom_score : up to 1000; where memory runs out, the highest goes first.
    """
    for kind, limit in limits.items():
        _, hard = resource.getrlimit(kind)
        soft = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
        resource.setrlimit(kind, (soft, hard))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with contextlib.suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text(str(oom_score), encoding="ascii")
