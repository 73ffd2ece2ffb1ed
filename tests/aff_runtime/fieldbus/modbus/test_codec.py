from __future__ import annotations

import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.base.signals import Status
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.registers import (
    Correction,
    Register,
    RegisterMap,
    StatusPlace,
    WordOrder,
    WordType,
)
from tests.aff_runtime.fieldbus.euclid_map import ANGLE_SCALE, command, euclid_map
from tests.each_case import each_case

FORMAT = {
    WordType.U16: ">H",
    WordType.I16: ">h",
    WordType.U32: ">I",
    WordType.I32: ">i",
    WordType.F32: ">f",
}
COUNTS = {
    WordType.U16: st.integers(0, 65535),
    WordType.I16: st.integers(-32768, 32767),
    WordType.U32: st.integers(0, 2**32 - 1),
    WordType.I32: st.integers(-(2**31), 2**31 - 1),
    WordType.F32: st.floats(width=32, allow_nan=False, allow_infinity=False),
}
SCALES = st.floats(1e-6, 1e3) | st.floats(-1e3, -1e-6)


def to_words(kind: WordType, order: WordOrder, counts: float) -> list[int]:
    raw = struct.pack(FORMAT[kind], counts)
    words = list(struct.unpack(f">{len(raw) // 2}H", raw))
    return words if order is WordOrder.HIGH_FIRST else words[::-1]


def from_words(kind: WordType, order: WordOrder, words: list[int]) -> float:
    ordered = words if order is WordOrder.HIGH_FIRST else words[::-1]
    (counts,) = struct.unpack(FORMAT[kind], struct.pack(f">{len(words)}H", *ordered))
    return float(counts)


def one_channel(register: Register) -> WordCodec:
    return WordCodec(euclid_map(plc_heartbeat=0, status=1, roll_id=4, channels=(register,)))


def read_block(words: list[int]) -> list[int]:
    return [7, 33, *[*words, 0][:2], 5]


def one_correction(kind: WordType, order: WordOrder, scale: float) -> tuple[WordCodec, int]:
    size = kind.word_count
    register = Register(name="u", address=3, type=kind, scale=scale, word_order=order)
    blocks = RegisterMap(
        plc_heartbeat=50,
        status=51,
        roll_id=52,
        channels=(),
        aff_heartbeat=0,
        state=1,
        echo=2,
        corrections=(Correction(register=register, complement_address=3 + size),),
    )
    return WordCodec(blocks), size


def test_the_default_block_decodes_to_si() -> None:
    words = [41, 0b101101, 0x0001, 0x5F90, 9000, 0xFC18, 10000, 1016, 12]
    words += [0xFFFF, 0xFFFE, 0, 4096, 0xFFFF, 0xF000]
    heartbeat, status, roll_id, values = WordCodec(euclid_map()).decode(words)
    assert (heartbeat, status, roll_id) == (41, 0b101101, 12)
    # 0x15F90 = 90000 counts of mN; 0xFC18 = -1000; one turn forward and one back
    expected = (90.0, 90.0, -1.0, 0.2, 1.016, -0.002, 2 * math.pi, -2 * math.pi)
    assert values == pytest.approx(expected, rel=1e-12)


APPLIED = (
    Register(name="unwind", address=16, type=WordType.I16, scale=0.00001),
    Register(name="swrap_follower", address=17, type=WordType.I16, scale=0.00001),
)


def test_the_words_behind_the_echo_are_what_the_plc_applies() -> None:
    codec = WordCodec(euclid_map(aff_echo=15, applied=APPLIED))
    assert codec.read_count == 18
    words = [*[0] * 15, 0xBEEF, 0xFB2E, 2000]  # 0xFB2E = -1234 counts
    assert codec.applied(words) == pytest.approx((-0.01234, 0.02), rel=1e-12)
    assert codec.aff_echo(words) == 0xBEEF
    assert codec.decode(words)[3][:2] == (0.0, 0.0)


def test_what_is_applied_of_one_of_two_leaves_the_other_unknown() -> None:
    codec = WordCodec(euclid_map(applied=(None, APPLIED[1])))
    first, second = codec.applied([*[0] * 17, 0x8000])
    assert math.isnan(first)
    assert second == pytest.approx(-0.32768, rel=1e-12)
    assert WordCodec(euclid_map()).applied([0] * 15) == ()


def test_the_default_block_encodes_to_golden_words() -> None:
    words = WordCodec(euclid_map()).encode(
        command(
            heartbeat=65536 + 3,
            state_bits=7,
            echo=41,
            corrections=(0.0123449, -0.00002),
            alarm=2,
            config_revision=0xABCDEF,
        )
    )
    # 0.0123449 m/s = 1234.49 counts -> 1234 = 0x04D2; -2 = 0xFFFE; limit 0.05 m/s = 5000 counts
    assert words == [3, 7, 41, 0x04D2, 0xFB2D, 2, 5000, 0xCDEF, 0xFFFE, 0x0001]


@given(st.sampled_from(WordType), st.sampled_from(WordOrder), SCALES, st.data())
def test_reading_inverts_an_independent_packing(
    kind: WordType, order: WordOrder, scale: float, data: st.DataObject
) -> None:
    counts = data.draw(COUNTS[kind])
    codec = one_channel(Register(name="x", address=2, type=kind, scale=scale, word_order=order))
    assert codec.decode(read_block(to_words(kind, order, counts))) == (7, 33, 5, (counts * scale,))


@given(
    st.sampled_from((WordType.I16, WordType.I32, WordType.F32)),
    st.sampled_from(WordOrder),
    SCALES,
    st.data(),
)
def test_a_correction_comes_back_within_half_a_count(
    kind: WordType, order: WordOrder, scale: float, data: st.DataObject
) -> None:
    counts = data.draw(st.floats(-32768, 32767))
    codec, size = one_correction(kind, order, scale)
    words = codec.encode(command(corrections=(counts * scale,)))
    sent = from_words(kind, order, words[3 : 3 + size])
    within = abs(counts) * 2**-23 if kind is WordType.F32 else 0.5 + 1e-9 * abs(counts)
    assert abs(sent - counts) <= within + 1e-30
    assert [word ^ 0xFFFF for word in words[3 : 3 + size]] == words[3 + size : 3 + 2 * size]


@each_case(
    ("kind", "value", "counts"),
    [
        (WordType.I16, 1e9, 32767),
        (WordType.I16, -1e9, -32768),
        (WordType.I32, 1e12, 2**31 - 1),
        (WordType.I32, -1e12, -(2**31)),
        (WordType.F32, 1e300, 3.4028234663852886e38),
        (WordType.F32, -1e300, -3.4028234663852886e38),
        *(
            (kind, value, 0)
            for kind in (WordType.I16, WordType.I32, WordType.F32)
            for value in (math.nan, math.inf, -math.inf)
        ),
    ],
)
def test_corrections_are_clipped_and_what_is_no_number_is_zero(
    kind: WordType, value: float, counts: float
) -> None:
    codec, size = one_correction(kind, WordOrder.LOW_FIRST, 1.0)
    words = codec.encode(command(corrections=(value,)))
    assert from_words(kind, WordOrder.LOW_FIRST, words[3 : 3 + size]) == counts


def test_a_missing_correction_goes_out_as_zero_and_not_as_the_last_one() -> None:
    codec = WordCodec(euclid_map())
    codec.encode(command(corrections=(0.01, 0.02)))
    words = codec.encode(command(corrections=(0.01,)))
    assert words[8:] == [0, 0xFFFF]


@each_case(
    ("limit", "word"), [(0.05, 5000), (math.nan, 0), (-1.0, 0), (1e9, 65535), (math.inf, 65535)]
)
def test_the_limit_word_saturates(limit: float, word: int) -> None:
    assert WordCodec(euclid_map()).encode(command(limits=(limit,)))[6] == word


@given(
    st.sampled_from((WordType.U16, WordType.I16, WordType.U32, WordType.I32)),
    st.sampled_from(WordOrder),
    st.data(),
)
def test_wrapping_counters_follow_any_walk(
    kind: WordType, order: WordOrder, data: st.DataObject
) -> None:
    bits = 16 * kind.word_count
    half = 1 << (bits - 1)
    position = data.draw(st.integers(-half, half - 1))
    codec = one_channel(
        Register(name="x", address=2, type=kind, word_order=order, scale=0.5, wraps=True)
    )
    unsigned = WordType.U16 if kind.word_count == 1 else WordType.U32
    for step in [0, *data.draw(st.lists(st.integers(-half, half - 1), max_size=8))]:
        position += step
        words = to_words(unsigned, order, position % (1 << bits))
        assert codec.decode(read_block(words))[3] == (position * 0.5,)


@given(
    st.sampled_from((WordType.U16, WordType.I16, WordType.U32, WordType.I32)),
    st.integers(8, 65536),
    st.data(),
)
def test_counters_that_start_over_within_their_words_follow_any_walk(
    kind: WordType, size: int, data: st.DataObject
) -> None:
    signed = kind in (WordType.I16, WordType.I32)
    least = -(size // 2) if signed else 0
    position = data.draw(st.integers(least, least + size - 1))
    codec = one_channel(
        Register(name="x", address=2, type=kind, scale=0.5, wraps=True, wraps_after=size)
    )
    for step in [0, *data.draw(st.lists(st.integers(-(size // 2), (size - 1) // 2), max_size=8))]:
        position += step
        shown = (position - least) % size + least
        words = to_words(kind, WordOrder.HIGH_FIRST, shown)
        assert codec.decode(read_block(words))[3] == (position * 0.5,)


def test_a_count_beyond_its_range_is_no_reading_and_loses_no_turn() -> None:
    codec = one_channel(Register(name="x", address=2, wraps=True, wraps_after=4096))
    read = [codec.decode(read_block([count]))[3][0] for count in (5000, 4000, 5000, 100)]
    assert read == [pytest.approx(math.nan, nan_ok=True), 4000, read[2], 4196]
    assert math.isnan(read[2])


def test_reset_forgets_the_turns_already_counted() -> None:
    codec = one_channel(
        Register(name="x", address=2, type=WordType.I32, scale=ANGLE_SCALE, wraps=True)
    )
    codec.decode(read_block([0x7FFF, 0xFFFF]))
    unwrapped = codec.decode(read_block([0x8000, 0x0000]))[3][0]
    codec.reset()
    restarted = codec.decode(read_block([0x8000, 0x0000]))[3][0]
    assert unwrapped == 2**31 * ANGLE_SCALE
    assert restarted == -(2**31) * ANGLE_SCALE


def test_a_device_without_alarm_limit_revision_and_copy_gets_four_words() -> None:
    register = Register(name="u", address=103, type=WordType.I16, scale=0.001)
    bare = euclid_map(
        alarm=None,
        limit=None,
        config_revision=None,
        corrections=(Correction(register=register, complement_address=None),),
    )
    words = WordCodec(bare).encode(command(heartbeat=1, corrections=(-0.001,)))
    assert words == [1, 0, 0, 0xFFFF]


def test_without_a_limit_in_force_the_limit_word_is_zero() -> None:
    assert WordCodec(euclid_map()).encode(command(limits=()))[6] == 0


def test_a_nan_on_the_wire_stays_nan() -> None:
    codec = one_channel(Register(name="x", address=2, type=WordType.F32))
    assert math.isnan(codec.decode(read_block([0x7FC0, 0x0000]))[3][0])


@given(st.integers(0, 0xFFFF), st.integers(0, 0xFFFF), st.booleans())
def test_status_bits_are_gathered_from_where_the_plc_has_them(
    own: int, other: int, inverted: bool
) -> None:
    places = (
        StatusPlace(means=Status.LINE_RUN, address=1, bit=15),
        StatusPlace(means=Status.WEB_INTACT, address=20, bit=0, inverted=inverted),
        StatusPlace(means=Status.ESTOP_OK, address=20, bit=7),
    )
    codec = WordCodec(euclid_map(status_places=places))
    words = [0] * codec.read_count
    words[1], words[20] = own, other
    expected = {
        Status.LINE_RUN: own >= 0x8000,
        Status.WEB_INTACT: (other % 2 == 1) is not inverted,
        Status.ESTOP_OK: other // 128 % 2 == 1,
    }
    status = codec.decode(words)[1]
    assert status == sum(int(bit) for bit, on in expected.items() if on)
