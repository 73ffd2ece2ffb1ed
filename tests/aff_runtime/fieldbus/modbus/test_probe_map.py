from __future__ import annotations

import socket
from pathlib import Path

import pytest

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import WireError
from aff_runtime.base.signals import Outcome
from aff_runtime.config.can_wire import can_map_of, wire_files
from aff_runtime.config.loader import load_site
from aff_runtime.fieldbus.modbus.probe_map import Decoding, decodings, probe_map
from aff_runtime.fieldbus.probe_frames import listen
from tests.aff_runtime.config.shipped import EUCLID
from tests.doubles.replay import ReplayTransport
from tests.doubles.virtual_clock import VirtualClock


def test_one_value_is_laid_out_in_all_four_orders() -> None:
    # 0x3FC00000 is 1.5 in IEEE 754
    one_and_a_half = 0x3FC00000
    for place, words in enumerate(
        [(0x3FC0, 0x0000), (0x0000, 0x3FC0), (0xC03F, 0x0000), (0x0000, 0xC03F)]
    ):
        row = decodings(*words)[place]
        assert (row.u32, row.i32, row.f32) == (one_and_a_half, one_and_a_half, 1.5)


def test_a_negative_double_word_shows_its_sign() -> None:
    assert decodings(0xFFFF, 0xFFFE)[0] == Decoding(
        order="high_first", u32=0xFFFFFFFE, i32=-2, f32=pytest.approx(float("nan"), nan_ok=True)
    )


def probe(rows: list[list[int] | Outcome], heartbeat_address: int = 40):
    return probe_map(
        ReplayTransport(rows),
        VirtualClock(),
        read_start=40,
        heartbeat_address=heartbeat_address,
        attempts=len(rows),
    )


def test_a_moving_heartbeat_and_a_frozen_one() -> None:
    rows: list[list[int] | Outcome] = [Outcome.NOT_CONNECTED, [1, 9], [2, 9], [2, 9], [3, 9]]
    seen = probe(rows)
    assert seen.heartbeat_moves
    assert not probe(rows, heartbeat_address=41).heartbeat_moves
    assert (seen.samples, seen.failures) == (4, 1)
    assert [word.changes for word in seen.words] == [2, 0]


def test_words_show_address_and_both_signs() -> None:
    seen = probe([[0, 65535], [0, 65535]])
    last = seen.words[-1]
    assert (last.address, last.u16, last.i16, last.decodings) == (41, 65535, -1, ())
    assert len(seen.words[0].decodings) == 4


def test_too_few_answers_are_an_error_that_names_the_last_failure() -> None:
    with pytest.raises(WireError, match="1 of 3 reads answered, last failure EXCEPTION"):
        probe([[1, 2], Outcome.TIMEOUT, Outcome.EXCEPTION])


@pytest.mark.parametrize(
    ("interface", "advice"),
    [("slcan_tty", "Is the adapter plugged in"), ("frame_socket", "Start the plant first")],
)
def test_a_bus_that_cannot_be_opened_is_named_with_the_driver_s_reason(
    tmp_path: Path, interface: str, advice: str
) -> None:
    site = load_site(EUCLID.parent / "euclid_can.yaml")
    frames = can_map_of(site, wire_files(site, EUCLID.parent))
    channel = str(tmp_path / "gone")
    with pytest.raises(WireError, match=f"gone cannot be opened .*No such file.*{advice}"):
        list(listen(frames, interface, channel, 500_000, VirtualClock()))


def test_a_silent_bus_is_not_called_a_stopped_plc(tmp_path: Path) -> None:
    site = load_site(EUCLID.parent / "euclid_canopen.yaml")
    frames = can_map_of(site, wire_files(site, EUCLID.parent))
    path = tmp_path / "can"
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as nobody:
        nobody.bind(str(path))
        nobody.listen(8)
        clock = MonotonicClock()
        said = list(listen(frames, "frame_socket", str(path), 500_000, clock, span_s=0.3))
    assert "no frame of the map came" in said[1]
    assert "0x183 unwind_drive.TPDO1" in said[2]
    assert "silent" in said[2]
