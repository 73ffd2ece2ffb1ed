"""What can be seen of the machine without a right: processors, kernel, our own process."""

from __future__ import annotations

import os
import resource
from dataclasses import dataclass
from pathlib import Path

SYS = Path("/sys")
LONGEST = 100
PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """As the kernel says it; empty or None where it cannot be seen.

    Attributes
    ----------
    governors : of the processors' frequency, each once. ``isolated`` : processors kept free.
    is_realtime : whether the kernel is one for real time. ``processors`` : how many there are.
    """

    governors: str
    isolated: str
    is_realtime: bool | None
    processors: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Own:
    """The screen server itself: processor time since its start, s; memory, MB."""

    cpu_s: float
    memory_MB: float | None


def machine(sys: Path = SYS) -> Machine:
    """Return what there is to see."""
    cpus = sys / "devices/system/cpu"
    governors = {_line(one) for one in sorted(cpus.glob("cpufreq/policy*/scaling_governor"))}
    realtime = _line(sys / "kernel/realtime")
    isolated = _line(cpus / "isolated")
    is_there = (cpus / "isolated").exists()
    return Machine(
        governors=", ".join(sorted(filter(None, governors))),
        isolated=isolated or ("-" if is_there else ""),
        is_realtime=realtime == "1" if cpus.exists() else None,
        processors=os.cpu_count(),
    )


def own() -> Own:
    """Return what this process has used."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
    except (OSError, ValueError, IndexError):
        pages = 0
    return Own(
        cpu_s=round(used.ru_utime + used.ru_stime, 1),
        memory_MB=round(pages * PAGE_BYTES / 1e6, 1) if pages else None,
    )


def _line(path: Path) -> str:
    try:
        with path.open(encoding="ascii", errors="replace") as file:
            return file.readline(LONGEST).strip()
    except OSError:
        return ""
