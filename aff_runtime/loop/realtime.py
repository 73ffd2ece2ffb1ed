"""Real-time rights: asked for one by one, reported as granted or refused, never required."""

from __future__ import annotations

import ctypes
import gc
import os
import struct
from collections.abc import Callable
from dataclasses import dataclass

_MCL_CURRENT_AND_FUTURE = 1 | 2
_PR_SET_TIMERSLACK = 29
_DMA_LATENCY_PATH = "/dev/cpu_dma_latency"


@dataclass(frozen=True, slots=True, kw_only=True)
class RealtimeRequest:
    """What to ask for.

    Attributes
    ----------
    fifo_priority : SCHED_FIFO priority 1..99; 0 does not ask.
    cpus : processors to stay on; empty does not ask.
    lock_memory : keep every page in memory.
    shallow_sleep : hold ``/dev/cpu_dma_latency`` at 0 us, so that no processor sleeps deeply.
    quiet_collector : freeze and stop Python's garbage collector; call after warm-up.
    timer_slack_ns : how late the kernel may end a sleep; 0 does not ask.
    """

    fifo_priority: int = 80
    cpus: tuple[int, ...] = ()
    lock_memory: bool = True
    shallow_sleep: bool = True
    quiet_collector: bool = True
    timer_slack_ns: int = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Grant:
    """One right: ``reason`` is empty when it was granted."""

    name: str
    granted: bool
    reason: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RealtimeReport:
    """What the system answered.

    Attributes
    ----------
    grants : one per right asked for.
    latency_fd : descriptor of ``shallow_sleep``, in force while it is open; -1: refused, or not
        asked for.
    """

    grants: tuple[Grant, ...]
    latency_fd: int = -1

    def lines(self) -> tuple[str, ...]:
        """Return one sentence per right."""
        return tuple(
            f"{grant.name}: granted" if grant.granted else f"{grant.name}: refused, {grant.reason}"
            for grant in self.grants
        )


def ask(request: RealtimeRequest) -> RealtimeReport:
    """Ask for every right of ``request`` for this process; refusals are reported, not raised."""
    grants: list[Grant] = []
    held = [-1]

    def hold_latency() -> None:
        held[0] = _hold_dma_latency()

    if request.lock_memory:
        grants.append(_try("memory locked", _lock_memory))
    if request.cpus:
        name = f"on processor {', '.join(map(str, request.cpus))}"
        grants.append(_try(name, lambda: os.sched_setaffinity(0, request.cpus)))
    if request.shallow_sleep:
        grants.append(_try(f"{_DMA_LATENCY_PATH} held at 0", hold_latency))
    if request.timer_slack_ns > 0:
        name = f"timer slack {request.timer_slack_ns} ns"
        grants.append(_try(name, lambda: _set_timer_slack(request.timer_slack_ns)))
    if request.quiet_collector:
        grants.append(_try("garbage collector off", _quiet_collector))
    if request.fifo_priority > 0:
        name = f"SCHED_FIFO {request.fifo_priority}"
        grants.append(_try(name, lambda: _set_fifo(request.fifo_priority)))
    return RealtimeReport(grants=tuple(grants), latency_fd=held[0])


def _try(name: str, action: Callable[[], None]) -> Grant:
    try:
        action()
    except (OSError, ValueError, OverflowError, AttributeError) as error:
        return Grant(name=name, granted=False, reason=str(error))
    return Grant(name=name, granted=True)


def _set_fifo(priority: int) -> None:
    policy = os.SCHED_FIFO | os.SCHED_RESET_ON_FORK
    os.sched_setscheduler(0, policy, os.sched_param(priority))


def _lock_memory() -> None:
    _check(ctypes.CDLL(None, use_errno=True).mlockall(_MCL_CURRENT_AND_FUTURE))


def _set_timer_slack(slack_ns: int) -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    _check(libc.prctl(_PR_SET_TIMERSLACK, ctypes.c_ulong(slack_ns), 0, 0, 0))


def _hold_dma_latency() -> int:
    fd = os.open(_DMA_LATENCY_PATH, os.O_WRONLY | os.O_CLOEXEC)
    try:
        os.write(fd, struct.pack("=i", 0))
    except OSError:
        os.close(fd)
        raise
    return fd


def _quiet_collector() -> None:
    gc.collect()
    gc.freeze()
    gc.disable()


def _check(result: int) -> None:
    if result != 0:
        code = ctypes.get_errno()
        raise OSError(code, os.strerror(code))
