import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.servers.map_file import load_plc_map
from tests.sim_plant.servers.fake_line import DEFAULT_MAP, default_map

VALUES = {
    "unwind_tension_N": 89.2,
    "tension_ref_N": 90.0,
    "line_speed_m_s": -0.5,
    "unwind_radius_m": 0.2,
    "swrap_follower_speed_m_s": 1.016,
    "pullroll_tension_N": -0.002,
    "unwind_angle_rad": 6.283185307179586,
    "swrap_follower_angle_rad": -6.283185307179586,
}
APPLIED = {"unwind": -0.01234, "swrap_follower": 0.02}
WORDS = {"plc_heartbeat": 7, "status": 0x6F, "roll_id": 3, "aff_echo": 0xBEEF}
# by hand from the table of docs/technician/gateway-block.md
GOLDEN = [
    7,
    0x6F,
    0x0001,
    0x5C70,
    9000,
    0xFE0C,
    10000,
    1016,
    3,
    0xFFFF,
    0xFFFE,
    0x0000,
    0x1000,
    0xFFFF,
    0xF000,
    0xBEEF,
    0xFB2E,
    2000,
]


def edited(tmp_path, *changes):
    text = DEFAULT_MAP.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "map.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_default_map_is_the_documented_block():
    plc_map = default_map()
    assert (plc_map.read_start, plc_map.read_count) == (0, 18)
    assert (plc_map.write_start, plc_map.write_count) == (100, 10)
    assert plc_map.encode_read(WORDS, VALUES, APPLIED) == GOLDEN
    assert (plc_map.watchdog_s, plc_map.regain_s, plc_map.fade_s) == (0.08, 0.02, 0.1)


def test_low_first_exchanges_the_words_of_32_bit_values_only(tmp_path):
    plc_map = load_plc_map(edited(tmp_path, ("word_order: high_first", "word_order: low_first")))
    words = plc_map.encode_read(WORDS, VALUES, APPLIED)
    assert words[2:4] == [0x5C70, 0x0001]
    assert words[4:9] == GOLDEN[4:9]
    assert plc_map.swap_read(words) == GOLDEN


BITS = (
    "status:        { address: 1 }",
    "status: { address: 1, bits: { LINE_RUN: { bit: 9 }, WEB_INTACT: { bit: 12, inverted: true }, "
    "ESTOP_OK: { address: 19, bit: 7 } } }",
)


def test_a_plc_with_an_order_of_its_own_shows_its_bits_there_and_no_others(tmp_path):
    plc_map = load_plc_map(edited(tmp_path, BITS))
    shown = plc_map.encode_read(WORDS, VALUES, APPLIED)
    assert [shown[0], *shown[2:18]] == [GOLDEN[0], *GOLDEN[2:]]
    assert (shown[1], shown[18:]) == (1 << 9, [0, 1 << 7])
    broken = plc_map.encode_read(WORDS | {"status": 0}, VALUES, APPLIED)
    assert (broken[1], broken[18:]) == (1 << 12, [0, 0])
    with pytest.raises(PlantError, match=r"bits.*unknown \['WEB'\]"):
        load_plc_map(edited(tmp_path, BITS, ("WEB_INTACT: { bit", "WEB: { bit")))


def test_address_base_one_is_one_less_on_the_wire(tmp_path):
    first = ("plc_heartbeat: { address: 0 }", "plc_heartbeat: { address: 19 }")
    path = edited(tmp_path, first, ("address_base: 0", "address_base: 1"))
    plc_map = load_plc_map(path)
    assert plc_map.write_start == 99
    assert plc_map.read == {"plc_heartbeat": 18, "status": 0, "roll_id": 7, "aff_echo": 14}


def test_a_plc_without_the_optional_words_has_a_block_that_is_shorter_by_them(tmp_path):
    lines = DEFAULT_MAP.read_text().splitlines(keepends=True)
    begin = next(n for n, line in enumerate(lines) if "applied:" in line)
    applied = "".join(lines[begin : begin + 3])
    echo = next(line for line in lines if "aff_echo" in line)
    without = load_plc_map(edited(tmp_path, (applied, "")))
    assert without.applied == ()
    assert without.encode_read(WORDS, VALUES, APPLIED) == GOLDEN[:-2]
    plain = load_plc_map(edited(tmp_path, (applied, ""), (echo, "")))
    assert "aff_echo" not in plain.read
    assert plain.encode_read(WORDS, VALUES, APPLIED) == GOLDEN[:-3]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            ("    swrap_follower: { address: 17", "    rewind: { address: 17"),
            r"read\.applied: \['rewind'\] have no correction",
        ),
        (("status:        { address: 1 }", "status:        { address: 2 }"), "used twice"),
        (("plc_heartbeat: { address: 0 }", "plc_heartbeat: { address: 400 }"), "longer than"),
        (("address_base: 0", "address_base: 1"), "outside 0..65535"),
        (("type: i32, scale: 0.001 }", "type: i24, scale: 0.001 }"), "type"),
        (("scale: 0.01 }", "scale: 1e-2 }"), "scale"),
        (("watchdog_ms: 80", "watchdog_s: 80"), "watchdog_s"),
        (("[LINE_RUN,", "[LINE_RUM,"), "LINE_RUM"),
        (("aff_heartbeat:   { address: 100 }", "aff_heartbeat:   { address: 14 }"), "overlap"),
    ],
)
def test_a_wrong_map_is_refused_by_name(tmp_path, change, said):
    with pytest.raises(PlantError, match=said):
        load_plc_map(edited(tmp_path, change))


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(PlantError, match=r"none\.yaml"):
        load_plc_map(tmp_path / "none.yaml")
