"""Cycle, guard and Modbus TCP together: no answers, no output."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from aff_runtime.base.signals import State
from tests.aff_runtime.app.fake_plc import Plc
from tests.aff_runtime.fieldbus.modbus_bytes import function_of
from tests.aff_runtime.fieldbus.runtime_at_work import ZERO_TICKS, Runtime, framed, site_on
from tests.aff_runtime.fieldbus.scripted_server import ScriptedServer, reset

pytestmark = pytest.mark.wire


def silent(_client: socket.socket, _request: bytes) -> None:
    return


def resetting(client: socket.socket, _request: bytes) -> None:
    reset(client)


@pytest.mark.parametrize("respond", [silent, resetting])
def test_without_answers_it_goes_to_zero_and_stays_there(tmp_path: Path, respond) -> None:
    plc = Plc()

    def answering(client: socket.socket, request: bytes) -> None:
        client.sendall(framed(plc, request))

    with ScriptedServer(answering) as server:
        runtime = Runtime(site_on("modbus_tcp", tmp_path, server.port), plc)
        asked = len(server.requests)
        server.respond = respond
        runtime.run(ZERO_TICKS)
        assert runtime.is_zero
        runtime.run(150)
        written = [r for r in server.requests[asked:] if function_of(r) == 23]
        assert len(written) == 1  # the one that got no answer; from then on it only reads
        server.respond = answering
        runtime.run(150)
        assert runtime.gateway.troubles == ()
        assert (plc.words[3], plc.words[8]) == (0, 0)
        assert runtime.guard.state is State.FAULT
        runtime.gateway.close()
