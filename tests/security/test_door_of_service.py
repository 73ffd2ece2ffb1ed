"""A running service whose door is flooded, deafened and taken away: nothing of it changes."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from aff_hmi.watch import Watch
from aff_runtime.app.supervisor.door import MAX_VISITORS
from aff_runtime.base.clock import MonotonicClock
from tests.aff_runtime.app.service_run import ServiceRun
from tests.processes import until

# quick, at the door itself: test_door.py; a service with one who looks in: app/test_service.py
pytestmark = [pytest.mark.long, pytest.mark.wire]
KEPT = ("state", "config_hash", "control_pid", "line", "probing")


@pytest.fixture(scope="module")
def _run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServiceRun]:
    with contextlib.closing(ServiceRun(tmp_path_factory.mktemp("service"))) as run:
        yield run


@pytest.fixture
def service(_run: ServiceRun) -> ServiceRun:
    """A running service that records, started anew where a test has ended it and is tried again.

    The recorder is a process of its own: on a busy machine its folder is there seconds after the
    service has its first signals.
    """
    if _run.has_ended():
        (_run.runtime_dir / "door.sock").unlink(missing_ok=True)
        _run.start_again()
    until("the service records", lambda: bool(_run.status()["recorder"]["folder"]))
    return _run


def ends_at(path: Path) -> int:
    """Return how many sockets the service has at its door: one listens, the others visit."""
    return sum(
        line.endswith(f" {path}") for line in Path("/proc/net/unix").read_text().splitlines()
    )


def standing(service: ServiceRun) -> dict[str, object]:
    """Return what a visitor must not change."""
    said = service.status()
    recorder = {name: said["recorder"][name] for name in ("folder", "alive", "rows_lost")}
    control = len(os.listdir(f"/proc/{said['control_pid']}/fd"))
    return {name: said[name] for name in KEPT} | recorder | {"descriptors": control}


def ticks(service: ServiceRun, count: int) -> None:
    """Wait until the control process has ticked so many times more."""
    first = service.status()["signals"]["tick"]
    until(f"{count} ticks", lambda: service.status()["signals"]["tick"] > first + count)


def knock(path: Path, said: bytes = b"") -> socket.socket | None:
    """Return one end that has come to a door and hears nothing; None when the queue was full."""
    end = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    end.setblocking(False)
    try:
        end.connect(str(path))
        if said:
            end.send(said)
    except OSError:
        end.close()
        return None
    return end


def test_a_flood_of_the_deaf_and_of_the_talkative_changes_nothing(service: ServiceRun) -> None:
    path = service.runtime_dir / "door.sock"
    before = standing(service)
    with contextlib.ExitStack() as deaf:
        for n in range(600):
            end = knock(path, b'{"do": "ar' if n % 3 == 0 else b"")
            if end is not None and n % 10 == 1:
                deaf.enter_context(end)
            elif end is not None:
                end.close()
        ticks(service, 20)
        assert standing(service) == before
        assert service.ask("shadow", on=True)["ok"]
        assert service.ask("shadow", on=False)["ok"]
        until("no more are in than may be", lambda: 1 < ends_at(path) <= 1 + MAX_VISITORS)
    until("all are let go", lambda: ends_at(path) == 1)
    assert not service.said("CONTROL_DIED")
    assert not service.said("Traceback")
    assert not (service.runtime_dir / "hand.sock").exists()  # nobody asked for one


def test_a_door_that_is_taken_away_takes_only_the_sight(service: ServiceRun) -> None:
    path = service.runtime_dir / "door.sock"
    with contextlib.closing(Watch(path, MonotonicClock())) as watch:

        def sees_ticks() -> bool:
            watch.poll()
            return watch.seen().tick_age_s is not None

        until("the screen sees ticks", sees_ticks)
        before = standing(service)
        path.unlink()
        path.write_text("somebody's own")
        ticks(service, 20)
        assert standing(service) == before
        with contextlib.closing(Watch(path, MonotonicClock())) as late:
            late.poll()
            assert "no service opens this door" in late.seen().trouble
        watch.poll()
        assert watch.seen().trouble == ""  # who was in stays in
        service.ask("stop")
        assert service.process.wait(30) == 0, "who looks on must not turn a stop into a failure"
        assert service.said("stopped; the correction reached zero")
        assert not service.said("Traceback")
        assert path.read_text() == "somebody's own"
        watch.poll()
        assert "closed the door" in watch.seen().trouble
