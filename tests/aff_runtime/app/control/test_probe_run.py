"""One probe inside the control process: how loud it is asked to be, and why it came to nothing."""

from __future__ import annotations

import contextlib
import gc
import math
import os
import signal
import socket
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from aff_runtime.app.control.probe_run import ProbeRun
from aff_runtime.app.link.messages import Probed, decode
from aff_runtime.app.link.packets import MAX_PACKET_BYTES, Link, link_pair
from aff_runtime.app.link.replies import ProbeResult
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.app.wiring.site_to_law import site_params
from aff_runtime.base.signals import State
from aff_runtime.config.loader import load_site
from aff_runtime.core.probe.probe import Stage
from aff_runtime.core.response import Response
from aff_runtime.fieldbus.modbus.byte_stream import Connecting
from aff_runtime.fieldbus.modbus.tcp_wire import TcpWire
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.ring import RingReader, RingWriter
from tests.aff_runtime.core.plants import measured
from tests.each_case import each_case

SITE = load_site(Path(__file__).parents[4] / "config" / "euclid_blocks.yaml")
GIVEN_M_S = 0.008


def former(sent_m_s: float) -> dict[str, Response]:
    one = measured(lambda _f: 250.0 + 0j, [0.5, 1.0])
    about = replace(one.provenance, amplitude=sent_m_s)
    return {"unwind": Response(points=one.points, delay_s=0.0, provenance=about)}


def run_of(responses: dict[str, Response], *, louder: bool) -> ProbeRun:
    return ProbeRun(
        SITE,
        ["unwind"],
        params=site_params(SITE),
        was_armed=False,
        config_hash="",
        version="",
        former=responses,
        louder=louder,
    )


@each_case(
    ("sent_m_s", "louder", "peak_m_s"),
    [
        (GIVEN_M_S, False, GIVEN_M_S),
        (GIVEN_M_S, True, 2 * GIVEN_M_S),
        (0.015, True, 0.02),  # the bound that the site file leaves at its default
        (math.nan, True, GIVEN_M_S),  # a response of an older release does not say
    ],
)
def test_a_louder_probe_sends_twice_what_was_sent_before(
    sent_m_s: float, louder: bool, peak_m_s: float
) -> None:
    run = run_of(former(sent_m_s), louder=louder)
    assert run._settings.amplitude == pytest.approx(peak_m_s)


def test_a_probe_that_never_begins_says_what_it_waited_for() -> None:
    run = run_of({}, louder=False)
    run.probe.waiting = "the line speed went from 1 to 1.1 m/s"
    assert run.probe.stage is Stage.LISTENING
    assert run.watch_tick(State.ACTIVE, 0) is False
    assert run.watch_tick(State.ACTIVE, round(run.duration_s / SITE.cycle_s) + 1) is True
    said = run.failure(State.ACTIVE, "")
    assert "did not end in" in said
    assert said.endswith("the line speed went from 1 to 1.1 m/s")


@pytest.fixture
def children(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[int]]:
    """The pids of what forks; they end with the test."""
    pids: list[int] = []
    fork, before = os.fork, signal.getsignal(signal.SIGCHLD)

    def forked() -> int:
        pid = fork()
        if pid:
            pids.append(pid)
        return pid

    monkeypatch.setattr(os, "fork", forked)
    yield pids
    for pid in pids:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
    signal.signal(signal.SIGCHLD, before)


def slow_fit(monkeypatch: pytest.MonkeyPatch, seconds: float) -> ProbeRun:
    run = run_of({}, louder=False)
    monkeypatch.setattr(run, "results", lambda _tick: time.sleep(seconds) or ())
    return run


def test_a_fit_holds_no_connection_open_that_the_tick_resets(
    monkeypatch: pytest.MonkeyPatch, children: list[int]
) -> None:
    ours, supervisor = link_pair()
    with socket.create_server(("127.0.0.1", 0)) as server:
        wire = TcpWire("127.0.0.1", server.getsockname()[1])
        assert wire.start_connect()
        peer, _ = server.accept()
        while wire.connecting() is Connecting.PENDING:
            time.sleep(0.001)
        slow_fit(monkeypatch, 300.0).fit_in_child(Link(ours), TickRow({}))
        wire.close(abort=True)
        peer.settimeout(60.0)  # far beyond what a child may take to begin
        with pytest.raises(ConnectionResetError):
            peer.recv(1)
        peer.close()
    assert len(children) == 1
    ours.close()
    supervisor.close()


def test_a_fit_does_not_make_a_dead_control_process_look_alive(
    monkeypatch: pytest.MonkeyPatch, children: list[int]
) -> None:
    ours, supervisor = link_pair()
    ring = RingWriter(("time_s",), meta=RunMeta())
    reader = RingReader(ring.open_for_readers())
    slow_fit(monkeypatch, 300.0).fit_in_child(Link(ours), TickRow({}))
    assert reader.writer_alive()
    os.close(ring._fd)  # as the kernel does after a kill: nobody unlocks
    del ring
    gc.collect()
    patience = 6000
    while reader.writer_alive() and patience:
        patience -= 1
        time.sleep(0.01)
    assert not reader.writer_alive()
    assert len(children) == 1
    ours.close()
    supervisor.close()


def test_a_fit_sends_its_result_over_the_link_that_it_keeps(
    monkeypatch: pytest.MonkeyPatch, children: list[int]
) -> None:
    ours, supervisor = link_pair()
    slow_fit(monkeypatch, 0.0).fit_in_child(Link(ours), TickRow({}))
    supervisor.settimeout(60.0)
    assert decode(supervisor.recv(MAX_PACKET_BYTES)) == Probed(results=())
    assert len(children) == 1
    ours.close()
    supervisor.close()


def test_a_result_that_does_not_fit_the_link_is_told_as_that(
    monkeypatch: pytest.MonkeyPatch, children: list[int]
) -> None:
    ours, supervisor = link_pair()
    text = "x" * MAX_PACKET_BYTES
    whole = ProbeResult(actuator="unwind", sign=1, remarks=(), delay_s=0.0, text=text)
    run = run_of({}, louder=False)
    monkeypatch.setattr(run, "results", lambda _tick: (whole,))
    run.fit_in_child(Link(ours), TickRow({}))
    supervisor.settimeout(60.0)
    said = decode(supervisor.recv(MAX_PACKET_BYTES))
    assert isinstance(said, Probed)
    assert said.error == "the result is too long for the link; probe fewer actuators"
    assert len(children) == 1
    ours.close()
    supervisor.close()
