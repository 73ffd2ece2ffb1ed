"""The end of a service in the middle of a probe, between real processes: what is said is so."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.aff_runtime.app.service_run import ServiceRun
from tests.aff_runtime.app.test_commissioning_kills import Asked, on_the_wire
from tests.doubles.run_reader import read_run
from tests.processes import is_running

pytestmark = [pytest.mark.wire, pytest.mark.timeout(120)]
IN_A_TERMINAL = """
import os, signal, sys
signal.signal(signal.SIGHUP, signal.SIG_DFL)
os.setsid()
os.open(sys.argv[1], os.O_RDWR)  # of a session's leader: its terminal
os.execv(sys.argv[2], sys.argv[2:])
"""


@pytest.fixture
def terminal() -> Iterator[tuple[int, int]]:
    """A terminal: the end of whoever looks at it, and that of the programs in it."""
    ours, theirs = os.openpty()
    yield ours, theirs
    for one in (ours, theirs):
        try:
            os.close(one)
        except OSError:
            continue


def test_a_terminal_that_closes_ends_the_service_with_a_fade(
    tmp_path: Path, terminal: tuple[int, int]
) -> None:
    ours, theirs = terminal
    run_as = (sys.executable, "-c", IN_A_TERMINAL, os.ttyname(theirs))
    service = ServiceRun(tmp_path, "--state-dir", "/nowhere", run_as=run_as)
    try:
        asked = Asked(service)
        status = service.status()
        control, folder = int(status["control_pid"]), Path(status["recorder"]["folder"])
        os.close(ours)  # as a closed window or a lost ssh does: SIGHUP to all of its processes
        assert service.process.wait(20) == 0
        assert not is_running(control)
        assert on_the_wire(service) == [0, 0]
        assert asked.answer() != "done"
        assert service.said("SIGHUP (terminal closed): the correction fades to zero")
        assert service.said("stopped; the correction reached zero")
        assert not service.said("died")
        assert read_run(folder).summary is not None, "the recorder wrote to the end"
    finally:
        service.close()


# quick, in virtual time: loop/test_last_zero.py; what is said: supervisor/test_end_of_service.py
@pytest.mark.long
def test_a_service_that_stops_while_the_plc_is_silent_claims_no_zero(tmp_path: Path) -> None:
    service = ServiceRun(tmp_path, "--state-dir", "/nowhere")
    try:
        Asked(service)
        service.plc.send_signal(signal.SIGSTOP)
        service.process.terminate()
        assert service.process.wait(20) == 5
        assert service.said("no answer of the PLC says that a zero arrived")
        assert service.said("stopped\n")
        assert not service.said("reached zero")
        assert not service.said("did not end in good order")
    finally:
        service.plc.send_signal(signal.SIGCONT)
        service.close()
