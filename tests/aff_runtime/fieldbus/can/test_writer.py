from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.fieldbus.can.writer import CanWriter
from tests.aff_runtime.fieldbus.euclid_can import DATABASE, command, euclid_map

WRITER = CanWriter(euclid_map())


def test_hand_written_bytes_go_out() -> None:
    frames = WRITER.encode(command(0x1203, (0.01234, -0.00001)))
    # heartbeat 0x1203, state 4, 1234 = 0x04D2, its complement 0xFB2D, all little endian
    assert frames[0] == (0x200, False, bytes.fromhex("0312 0400 D204 2DFB"))
    # -1 = 0xFFFF, complement 0x0000, counter 0x03
    assert frames[1] == (0x201, False, bytes.fromhex("FFFF 0000 03"))
    # 0x1203 % 3 = 0 -> page 0: alarm 0; counter, echo 7
    assert frames[2] == (0x202, False, bytes.fromhex("00 03 0700 0000"))


def test_pages_go_round() -> None:
    seen = {WRITER.encode(command(n))[2].data[0]: WRITER.encode(command(n))[2] for n in range(3)}
    assert seen[1].data[4:] == (5000).to_bytes(2, "little")  # limit 0.05 m/s in counts of 1e-5
    assert seen[2].data[4:] == bytes.fromhex("EFBE")


@given(
    st.integers(0, 0xFFFF), st.floats(allow_nan=True, allow_infinity=True), st.floats(-0.3, 0.3)
)
def test_cantools_reads_back_what_was_meant(heartbeat: int, first: float, second: float) -> None:
    frames = WRITER.encode(command(heartbeat, (first, second)))
    wanted = min(max(first, -0.32767), 0.32767) if abs(first) < 1e13 else 0.0
    for frame, name, value in (
        (frames[0], "Unwind", wanted),
        (frames[1], "SwrapFollower", second),
    ):
        shown = DATABASE.decode_message(frame.can_id, frame.data)
        raw = DATABASE.decode_message(frame.can_id, frame.data, scaling=False)
        assert isinstance(shown, dict)
        assert isinstance(raw, dict)
        assert shown[name] == pytest.approx(value, abs=0.5001e-5)
        assert (raw[name] & 0xFFFF) ^ raw[f"{name}Complement"] == 0xFFFF


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_goes_out_as_zero(value: float) -> None:
    assert WRITER.encode(command(1, (value,)))[0].data[4:] == bytes.fromhex("0000FFFF")
