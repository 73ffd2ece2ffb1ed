"""What can be seen of the machine without a right: processors and kernel."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

SYS = Path("/sys")
MACHINE_ID = Path("/etc/machine-id")
LONGEST = 100  # characters that are read of one file


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


def machine_name(seen: Machine, machine_id: Path = MACHINE_ID) -> str:
    """Return which machine this is: kernel, processors, and a digest of its own number.

    The number itself is nobody's business: who has it can tell the machine in other programs.
    """
    kernel = " ".join((os.uname().sysname, os.uname().release, os.uname().machine))
    parts = [kernel]
    if seen.processors is not None:
        parts.append(f"{seen.processors} processors")
    if number := _line(machine_id):
        parts.append(hashlib.sha256(f"aff-runtime {number}".encode()).hexdigest()[:12])
    return ", ".join(parts)


def _line(path: Path) -> str:
    try:
        with path.open(encoding="ascii", errors="replace") as file:
            return file.readline(LONGEST).strip()
    except OSError:
        return ""
