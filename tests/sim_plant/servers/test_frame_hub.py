"""The socket of a bench bus: one plant at a path; one that was left behind is taken over."""

from __future__ import annotations

import asyncio
import socket
import struct
from pathlib import Path

import pytest

from aff_runtime.base.errors import WireError
from sim_plant.servers.frame_hub import FrameHub

pytestmark = pytest.mark.processes


def test_a_second_plant_does_not_take_the_path_of_the_first(tmp_path: Path) -> None:
    path = tmp_path / "can"

    async def both() -> None:
        first, second = FrameHub(path), FrameHub(path)
        first.open(lambda frame: None)
        try:
            with pytest.raises(WireError, match="another plant listens there"):
                second.open(lambda frame: None)
            with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as party:
                party.connect(str(path))
        finally:
            first.close()

    asyncio.run(both())


def test_a_path_that_a_killed_plant_left_behind_is_taken_over(tmp_path: Path) -> None:
    path = tmp_path / "can"
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as dead:
        dead.bind(str(path))
    assert path.exists()

    async def start() -> None:
        hub = FrameHub(path)
        hub.open(lambda frame: None)
        hub.close()

    asyncio.run(start())


def test_a_remote_or_error_frame_carries_no_data_to_the_plant(tmp_path: Path) -> None:
    path = tmp_path / "can"
    taken: list[int] = []

    async def talk() -> None:
        hub = FrameHub(path)
        hub.open(lambda frame: taken.append(frame.can_id))
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as party:
                party.connect(str(path))
                for can_id in (0x4000_0200, 0x2000_0200, 0x201):
                    party.send(struct.pack("=IB3x8s", can_id, 8, bytes(8)))
                while 0x201 not in taken:
                    await asyncio.sleep(0.001)
        finally:
            hub.close()

    asyncio.run(asyncio.wait_for(talk(), 5.0))
    assert taken == [0x201]
