from __future__ import annotations

import pytest

from aff_runtime.base.errors import ConfigError
from aff_runtime.fieldbus.modbus.registers import Correction, Register, WordType, wire_address
from tests.aff_runtime.fieldbus.euclid_map import correction, euclid_map
from tests.each_case import each_case


@each_case(
    ("register", "base", "address"),
    [
        (0, 0, 0),
        (8501, 0, 8501),  # Schneider: as printed
        (1, 1, 0),
        (40001, 1, 0),
        (40101, 1, 100),
        (400001, 1, 0),  # ABB
        (50000, 1, 49999),  # Danfoss
        (65535, 0, 65535),
        (65536, 1, 65535),
    ],
)
def test_manual_numbers_become_wire_addresses(register: int, base: int, address: int) -> None:
    assert wire_address(register, base) == address


@each_case(("register", "base"), [(0, 1), (-1, 0), (65536, 0), (65537, 1), (1, 2)])
def test_numbers_without_a_wire_address_are_refused(register: int, base: int) -> None:
    with pytest.raises(ConfigError):
        wire_address(register, base)


def test_blocks_cover_exactly_the_named_words() -> None:
    blocks = euclid_map()
    assert (blocks.read_start, blocks.read_count) == (0, 15)
    assert (blocks.write_start, blocks.write_count) == (100, 10)


def test_a_read_block_may_skip_words() -> None:
    blocks = euclid_map(
        plc_heartbeat=20, status=24, roll_id=22, channels=(Register(name="a", address=30),)
    )
    assert (blocks.read_start, blocks.read_count) == (20, 11)


def test_an_applied_correction_belongs_to_each_correction_or_to_none() -> None:
    word = Register(name="unwind", address=16, type=WordType.I16, scale=0.00001)
    assert euclid_map(applied=(word, None)).read_count == 17
    with pytest.raises(ConfigError, match="applied: give one entry per correction"):
        euclid_map(applied=(word,))


def test_a_gap_in_the_write_block_is_refused_by_address() -> None:
    with pytest.raises(ConfigError, match=r"100\.\.109 would overwrite wire address 105,"):
        euclid_map(alarm=None)


def test_optional_words_may_be_absent_at_the_end() -> None:
    blocks = euclid_map(
        alarm=None, limit=None, config_revision=None, corrections=(correction("u", 103, None),)
    )
    assert (blocks.write_start, blocks.write_count) == (100, 4)


def test_two_owners_of_one_written_word_are_refused() -> None:
    with pytest.raises(ConfigError, match="103 already carries echo"):
        euclid_map(echo=103)


def test_writing_a_word_of_the_plc_is_refused() -> None:
    with pytest.raises(ConfigError, match="word the PLC writes"):
        euclid_map(plc_heartbeat=106)


def test_a_second_half_counts_as_owned() -> None:
    wide = Register(name="wide", address=103, type=WordType.I32)
    with pytest.raises(ConfigError, match="104 already carries wide"):
        euclid_map(corrections=(Correction(register=wide, complement_address=104),))


def test_a_read_block_longer_than_a_frame_is_refused() -> None:
    with pytest.raises(ConfigError, match="126 words"):
        euclid_map(
            plc_heartbeat=1000,
            status=1001,
            roll_id=1125,
            channels=(),
            corrections=(),
            alarm=103,
            limit=104,
            config_revision=105,
        )


@each_case(
    "bad",
    [
        {"address": 65535, "type": WordType.I32},
        {"address": -1},
        {"address": 0, "scale": 0.0},
        {"address": 0, "scale": float("nan")},
        {"address": 0, "type": WordType.F32, "wraps": True},
        {"address": 0, "wraps": True, "wraps_after": 65537},
    ],
)
def test_impossible_registers_are_refused(bad: dict[str, object]) -> None:
    with pytest.raises(ConfigError):
        Register(name="x", **bad)  # type: ignore[arg-type]


def test_an_unsigned_correction_is_refused() -> None:
    with pytest.raises(ConfigError, match="has a sign"):
        Correction(register=Register(name="u", address=3), complement_address=4)


def test_a_wrapping_correction_is_refused() -> None:
    register = Register(name="u", address=3, type=WordType.I32, wraps=True)
    with pytest.raises(ConfigError, match="cannot wrap"):
        Correction(register=register, complement_address=None)


def test_a_copy_off_the_wire_is_refused() -> None:
    with pytest.raises(ConfigError, match="complement address 65536"):
        correction("u", 3, 65536)


@pytest.mark.parametrize("word", ["plc_heartbeat", "state"])
def test_a_word_off_the_wire_is_refused(word: str) -> None:
    with pytest.raises(ConfigError, match=r"outside 0\.\.65535"):
        euclid_map(**{word: -1})


def test_a_write_block_longer_than_a_frame_is_refused() -> None:
    pairs = tuple(correction(f"u{n}", 103 + 2 * n, 104 + 2 * n) for n in range(60))
    with pytest.raises(ConfigError, match="123 words"):
        euclid_map(alarm=None, limit=None, config_revision=None, corrections=pairs)
