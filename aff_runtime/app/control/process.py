"""The control process: ``python -m aff_runtime.app.control.process --link-fd N``.

Started by the supervisor with one end of a socketpair. It imports everything before its first
tick and then does nothing but ticks: no logging, no files, no waiting for anybody but its
deadline and the PLC. The end of the link, SIGTERM and SIGUSR1 all lead to zero.
"""

from __future__ import annotations

import argparse
import os
import select
import signal
import socket
import sys

from aff_runtime.app.control.outside import ControlOutside
from aff_runtime.app.link.messages import EXIT_UNHEARD, LogLine, Start
from aff_runtime.app.link.packets import Link, LinkClosedError
from aff_runtime.app.wiring.assemble import assemble, cycle_of
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import AffError, WireError
from aff_runtime.base.printable import printable
from aff_runtime.loop.realtime import RealtimeReport, RealtimeRequest, ask
from aff_runtime.telemetry.header import Right, RunMeta

START_PATIENCE_S = 10.0
"""How long to wait for the supervisor's first message."""


def main(arguments: list[str]) -> int:
    """Run the cycle until a stop message; return the exit code."""
    parser = argparse.ArgumentParser(prog="aff_runtime.app.control.process")
    parser.add_argument("--link-fd", type=int, required=True)
    options = parser.parse_args(arguments)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # ctrl-c is the supervisor's,
    signal.signal(signal.SIGHUP, signal.SIG_IGN)  # and so is a terminal that closes
    link = Link(socket.socket(fileno=options.link_fd))
    try:
        start = _first_message(link)
        return _run(start, link)
    except LinkClosedError:
        return WireError.exit_code
    except AffError as error:
        for line in str(error).split("\n"):
            link.send(LogLine(text=printable(line)))
        return error.exit_code


def _run(start: Start, link: Link) -> int:
    """Wire the rooms and tick."""
    clock = MonotonicClock()
    parameters = start.record
    assembly = assemble(parameters, clock)
    rights = ask(RealtimeRequest(cpus=_own_processor()))
    meta = RunMeta(
        config_hash=parameters.config_hash,
        versions=parameters.versions,
        rights=tuple(
            Right(granted=grant.granted, text=text)
            for grant, text in zip(rights.grants, rights.lines(), strict=True)
        ),
        machine=" ".join(os.uname()),
        start_ns=clock.now_ns(),
        shadow=start.shadow,
        heartbeat_modulus=assembly.gateway.heartbeat_modulus,
    )
    outside = ControlOutside(assembly, link, meta)
    cycle = cycle_of(assembly, outside)
    signal.signal(signal.SIGUSR1, lambda *_: outside.bypass_by_signal())
    signal.signal(signal.SIGTERM, lambda *_: cycle.request_stop())
    # blocked by who started us
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGUSR1, signal.SIGHUP})
    cycle.run()
    outside.close()
    assembly.gateway.close()
    _release(rights)
    return 0 if cycle.zero_stands else EXIT_UNHEARD


def _first_message(link: Link) -> Start:
    """Wait for the parameter record."""
    select.select([link], [], [], START_PATIENCE_S)
    message = link.receive()
    if not isinstance(message, Start):
        raise LinkClosedError
    return message


def _own_processor() -> tuple[int, ...]:
    """Return the last processor when there are several: interrupts favour the first."""
    allowed = sorted(os.sched_getaffinity(0))
    return (allowed[-1],) if len(allowed) > 1 else ()


def _release(rights: RealtimeReport) -> None:
    """Let the processors sleep again."""
    if rights.latency_fd >= 0:
        os.close(rights.latency_fd)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
