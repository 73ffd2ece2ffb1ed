"""How long the screen waits for its commissioner: one that hangs is known soon."""

from __future__ import annotations

import asyncio
import socket
from pathlib import Path

import pytest

from aff_hmi.commission import link
from aff_hmi.commission.link import PATIENCE_S, STATE_PATIENCE_S, Commission
from aff_runtime.app.commission.link.answers import CardShown, Done, State
from aff_runtime.app.commission.link.messages import Refusal, Request, Why


def test_how_it_stands_is_told_from_memory_and_not_waited_for_as_a_job_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    waited: dict[str, float] = {}

    async def ask(path: Path, asked: Request, patience_s: float) -> Done:
        waited[asked.do] = patience_s
        return Done()

    monkeypatch.setattr(link, "ask", ask)
    commission = Commission(Path("/nowhere"))
    asyncio.run(commission.look(Request(do="state"), State))
    asyncio.run(commission.look(Request(do="card"), CardShown))
    assert waited == {"state": STATE_PATIENCE_S, "card": PATIENCE_S}


def test_a_commissioner_that_takes_a_request_and_says_nothing_is_silent(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As one under SIGSTOP: the kernel lets the screen in, and nobody reads."""
    monkeypatch.setattr(link, "STATE_PATIENCE_S", 0.1)
    folder = tmp_path / "rt"
    folder.mkdir(mode=0o700)
    path = folder / "commission.sock"
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as listener:
        listener.bind(str(path))
        listener.listen()
        found = asyncio.run(Commission(path).look(Request(do="state"), State))
    assert found == Refusal(why=Why.SILENT)
