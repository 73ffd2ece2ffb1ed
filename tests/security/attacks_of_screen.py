"""Run as the screen's user against a running service: every deed that must not be done.

Prints JSON: what became of each, ``done`` or why not. Nothing of a test is imported here.
"""

from __future__ import annotations

import ctypes
import fcntl
import json
import mmap
import os
import resource
import secrets
import signal
import socket
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from aff_runtime.app.door.client import DoorClient
from aff_runtime.app.door.messages import RingPassed
from aff_runtime.app.hand.client import HandClient
from aff_runtime.app.hand.may import Action, Place, Role
from aff_runtime.app.hand.messages import VALID_NS, Answer, Command
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import AffError

PTRACE_ATTACH, PTRACE_SEIZE = 16, 0x4206
LIBC = ctypes.CDLL(None, use_errno=True)


class RefusedError(Exception):
    """A deed was refused by what it was tried on."""


def checked(result: int) -> None:
    if result < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


def of_process(pid: int) -> dict[str, Callable[[], object]]:
    """Return what would signal, trace, read or starve one process."""

    def read_memory() -> None:
        found = ctypes.create_string_buffer(8)

        class Part(ctypes.Structure):
            _fields_ = (("at", ctypes.c_void_p), ("size", ctypes.c_size_t))

        ours, theirs = Part(ctypes.addressof(found), 8), Part(0x10000, 8)
        checked(LIBC.process_vm_readv(pid, ctypes.byref(ours), 1, ctypes.byref(theirs), 1, 0))

    def trace(how: int) -> Callable[[], None]:
        return lambda: checked(LIBC.ptrace(how, pid, 0, 0))

    def by_descriptor() -> None:
        descriptor = os.pidfd_open(pid)
        signal.pidfd_send_signal(descriptor, signal.SIGKILL)

    return {
        "signal it": lambda: os.kill(pid, 0),
        "stop it": lambda: os.kill(pid, signal.SIGSTOP),
        "kill it": lambda: os.kill(pid, signal.SIGKILL),
        "kill it by a descriptor": by_descriptor,
        "have it bypass by a signal": lambda: os.kill(pid, signal.SIGUSR1),
        "attach to it": trace(PTRACE_ATTACH),
        "seize it": trace(PTRACE_SEIZE),
        "read its memory": read_memory,
        "open its memory": lambda: Path(f"/proc/{pid}/mem").open("r+b").close(),
        "read its environment": lambda: Path(f"/proc/{pid}/environ").read_bytes()[0],
        "see its descriptors": lambda: os.listdir(f"/proc/{pid}/fd"),
        "see its maps": lambda: Path(f"/proc/{pid}/maps").read_text()[0],
        "take its processors": lambda: os.sched_setaffinity(pid, {0}),
        "take its priority": lambda: os.sched_setscheduler(pid, os.SCHED_BATCH, os.sched_param(0)),
        "make it nice": lambda: os.setpriority(os.PRIO_PROCESS, pid, 19),
        "limit its time": lambda: resource.prlimit(pid, resource.RLIMIT_CPU, (1, 1)),
        "limit its files": lambda: resource.prlimit(pid, resource.RLIMIT_NOFILE, (3, 3)),
    }


def of_itself() -> dict[str, Callable[[], object]]:
    """Return what would make more of its own process than it is."""
    fifo = os.sched_param(1)
    return {
        "become root": lambda: os.setuid(0),
        "become another group": lambda: os.setgroups([0]),
        "go before others": lambda: os.sched_setscheduler(0, os.SCHED_FIFO, fifo),
        "be nicer to itself": lambda: os.setpriority(os.PRIO_PROCESS, 0, -5),
        "mount": lambda: checked(LIBC.mount(b"/tmp", b"/tmp", None, 4096, None)),
        "change root": lambda: os.chroot("/tmp"),
    }


def of_files(place: dict[str, str]) -> dict[str, Callable[[], object]]:
    """Return what would open, change or take away what is the service's."""
    runtime, state, key = Path(place["runtime"]), Path(place["state"]), Path(place["key"])
    door, site = Path(place["door"]), Path(place["site"])
    (audit,) = place["audit"].split()

    def connect(path: Path) -> Callable[[], None]:
        return lambda: socket.socket(socket.AF_UNIX).connect(str(path))

    found: dict[str, Callable[[], object]] = {
        "command": connect(runtime / "control.sock"),
        "look into the runtime folder": lambda: os.listdir(runtime),
        "look into the state": lambda: os.listdir(state),
        "open the key": key.read_bytes,
        "change the site file": lambda: site.open("a").close(),
        "take the site file away": lambda: site.rename(site.with_name("x")),
        "read the audit": lambda: Path(audit).read_bytes(),
        "add to the audit": lambda: Path(audit).open("ab").close(),
        "take the audit away": lambda: Path(audit).unlink(),
        "make something in the door's folder": (door.parent / "other").touch,
    }
    for name in ("door.sock", "hand.sock"):
        path = door.with_name(name)
        found |= {
            f"take {name} away": path.unlink,
            f"move {name}": partial(path.rename, path.with_name("other")),
            f"open {name} to others": partial(path.chmod, 0o666),
        }
    return found


def ring_of(door: Path) -> int:
    """Return the descriptor that every visitor gets."""
    client, end = DoorClient(door), time.monotonic() + 20.0
    while time.monotonic() < end:
        message = client.receive()
        if isinstance(message, RingPassed):
            return message.descriptor
        time.sleep(0.01)
    raise SystemExit("no ring came")


def of_ring(descriptor: int) -> dict[str, Callable[[], object]]:
    """Return what would change or hold the ring."""
    again = f"/proc/self/fd/{descriptor}"
    writable = mmap.PROT_READ | mmap.PROT_WRITE
    return {
        "write the ring": lambda: os.pwrite(descriptor, b"\0" * 8, 4096),
        "map it to write": lambda: mmap.mmap(descriptor, 4096, mmap.MAP_SHARED, writable),
        "cut it": lambda: os.ftruncate(descriptor, 0),
        "open it again to write": lambda: os.open(again, os.O_RDWR),
        "open it to others": lambda: os.fchmod(descriptor, 0o666),
        "lock it": lambda: fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB),
    }


def of_hand(path: Path) -> dict[str, Callable[[], object]]:
    """Return what would get more than the ceiling, which is ``view``."""

    def press(action: str) -> Callable[[], None]:
        def deed() -> None:
            client = HandClient(path)
            ident = secrets.token_hex(16)
            until_ns = MonotonicClock().now_ns() + VALID_NS
            client.say(
                Command(
                    id=ident,
                    action=Action(action),
                    account="root",
                    role=Role.COMMISSION,
                    place=Place.PANEL,
                    seen="FAULT",
                    valid_until_ns=until_ns,
                )
            )
            end = time.monotonic() + 10.0
            while time.monotonic() < end:
                told = client.receive()
                if isinstance(told, Answer):
                    if not told.ok:
                        raise RefusedError(told.reason.text if told.reason else "")
                    return
                time.sleep(0.005)
            raise RefusedError("no answer")

        return deed

    def babble() -> None:
        end = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        end.settimeout(5.0)
        end.connect(str(path))
        end.send(json.dumps({"do": "stop"}).encode())
        while said := end.recv(4096):
            if b"refused" in said:
                break
        raise RefusedError("sent away")

    def flood() -> None:
        client = HandClient(path)
        for _ in range(2000):
            client.say(
                Command(
                    id=secrets.token_hex(16),
                    action=Action.ARM,
                    account="x",
                    role=Role.COMMISSION,
                    place=Place.PANEL,
                    seen="FAULT",
                    valid_until_ns=2**62,
                )
            )
        raise RefusedError("heard, and nothing done")

    return {
        "arm": press("arm"),
        "probe": press("probe"),
        "stop the service": babble,
        "arm by a flood": flood,
    }


def main() -> None:
    place: dict[str, Any] = json.loads(sys.argv[1])
    deeds: dict[str, Callable[[], object]] = {}
    for name, pid in place["pids"].items():
        deeds |= {f"{name}: {deed}": do for deed, do in of_process(pid).items()}
    if "door" in place:
        door = Path(place["door"])
        deeds |= {**of_itself(), **of_files(place), **of_ring(ring_of(door))}
        deeds |= of_hand(door.with_name("hand.sock"))
    if wanted := place.get("deeds"):
        deeds = {name: do for name, do in deeds.items() if name.partition(": ")[2] in wanted}
    became = {}
    for name, do in deeds.items():
        try:
            do()
            became[name] = "done"
        except (OSError, ValueError, AffError, RefusedError) as error:
            became[name] = f"{type(error).__name__}: {error}"
    print(json.dumps(became))


if __name__ == "__main__":
    main()
