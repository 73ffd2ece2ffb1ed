"""Bad site files: each message stands at the exact line and column and says what to do."""

import math

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from aff_runtime.base.errors import ConfigError
from aff_runtime.config.leaves import leaves
from aff_runtime.config.loader import load_site, read_site
from tests.aff_runtime.config.shipped import EUCLID, edited, place

CASES = {
    "wrong key": (
        ("settle_s: 6,", "setle_s: 6,"),
        "setle_s: 6,",
        "actuators.unwind.blocks[0].setle_s: unknown key. Did you mean settle_s?",
    ),
    "unknown key": (
        ("  cycle_ms: 5", "  zzz: 5"),
        "zzz",
        "line.zzz: unknown key. Known here: name, cycle_ms, speed, speed_max_m_s.",
    ),
    "duplicate key": (
        ("  cycle_ms: 5", "  name: again"),
        "name: again",
        "line.name: key stands twice, first in line 15. Remove one of the two.",
    ),
    "bare exponent": (
        ("settle_s: 6,", "settle_s: 1e1,"),
        "1e1",
        'actuators.unwind.blocks[0].settle_s: "1e1" is text, not a number (YAML 1.1). Write 10.',
    ),
    "wrong unit": (
        ("    limit_m_s: 0.05", "    limit_m_s: 20 lbf"),
        "20 lbf",
        'actuators.unwind.limit_m_s: "20 lbf" is a force, expected a speed: a number in m/s, or '
        "with its unit (m/min, mm/s, cm/s).",
    ),
    "decimal comma": (
        ("    limit_m_s: 0.05", "    limit_m_s: 0,05"),
        "0,05",
        'actuators.unwind.limit_m_s: "0,05" has a decimal comma. Write 0.05.',
    ),
    "decimal comma in braces": (
        ("amp_limit_m_s: 0.02", "amp_limit_m_s: 0,02"),
        "0,02",
        'actuators.unwind.blocks[0].amp_limit_m_s: "0,02" has a decimal comma. Write 0.02.',
    ),
    "too large": (
        ("settle_s: 6,", "settle_s: 6 min,"),
        "6 min",
        "actuators.unwind.blocks[0].settle_s: 6 min (= 360 s) is too large. Allowed: 1 to 300 s.",
    ),
    "too small": (
        ("hold_after_ms: 15", "hold_after_ms: 1"),
        "1\n",
        "freshness.hold_after_ms: 1 ms is too small. Allowed: 2 to 200 ms.",
    ),
    "order out of bounds": (
        ("orders: [1, 2, 3, 4]", "orders: [1, 2, 65, 4]"),
        "65",
        "actuators.unwind.blocks[0].orders[2]: 65 is too large. Allowed: 1 to 64.",
    ),
    "not whole": (
        ("port: 5020", "port: 5020.0"),
        "5020.0",
        "gateway.modbus_tcp.port: 5020.0 is not a whole number. Write 5020.",
    ),
    "number as text": (
        ("port: 5020", 'port: "5020"'),
        '"5020"',
        "gateway.modbus_tcp.port: 5020 is not a whole number. Allowed: 1 to 65535.",
    ),
    "boolean as a whole number": (
        ("address_base: 0", "address_base: no"),
        "no\n",
        "gateway.address_base: no is not a whole number. Allowed: 0, 1.",
    ),
    "boolean as text": (
        ("name: Euclid", "name: off"),
        "off\n",
        'line.name: off is a boolean in YAML 1.1, not text. Write "off".',
    ),
    "number for text": (
        ("name: Euclid", "name: 7"),
        "7\n",
        'line.name: 7 is a number, not text. Write "7".',
    ),
    "text as boolean": (
        ("wraps: true", "wraps: sure"),
        "sure",
        "gateway.read.channels.unwind_angle_rad.wraps: sure is neither true nor false. "
        "Write true or false.",
    ),
    "wrong word": (
        ("word_order: high_first", "word_order: high_frist"),
        "high_frist",
        "gateway.word_order: high_frist is not known here. Did you mean high_first? Write one "
        "of: high_first, low_first.",
    ),
    "empty value": (
        ("  cycle_ms: 5", "  cycle_ms:"),
        "cycle_ms:\n",
        "line.cycle_ms: is empty. Write a value, or put # before the key to use its default.",
    ),
    "empty name": (
        ("name: Euclid", 'name: ""'),
        '""',
        "line.name: text of 0 characters. Write 1 to 200.",
    ),
    "value for a section": (
        ("plc_heartbeat: { register: 0 }", "plc_heartbeat: 0"),
        "0\n",
        'gateway.read.plc_heartbeat: "0" stands where a section is expected. Its keys: '
        "register, signal, type.",
    ),
    "value for a list": (
        ("orders: [1, 2, 3, 4]", "orders: 4"),
        "4",
        'actuators.unwind.blocks[0].orders: "4" stands where a list is expected. Write [4].',
    ),
    "empty list": (
        ("orders: [1, 2, 3, 4]", "orders: []"),
        "[]",
        "actuators.unwind.blocks[0].orders: needs 1 to 64 entries.",
    ),
    "bad scale": (
        ("scale: 0.02 mm", "scale: 0.02 mN"),
        "0.02 mN",
        'gateway.read.channels.unwind_radius_m.scale: "0.02 mN" is a force, expected a length',
    ),
    "zero scale": (
        ("type: u16, scale: 0.01 ", "type: u16, scale: 0 "),
        "0 ",
        "gateway.read.channels.tension_ref_N.scale: 0 would make every value 0.",
    ),
    "overlap": (
        ("tension_ref_N: { register: 4,", "tension_ref_N: { register: 3,"),
        "3,",
        "gateway.read.channels.tension_ref_N.register: wire address 3 is taken by "
        "gateway.read.channels.unwind_tension_N (i32, 2..3). Move one of the two.",
    ),
    "write on read": (
        ("state: { register: 101 }", "state: { register: 14 }"),
        "14 }",
        "gateway.write.state.register: wire address 14 is taken by "
        "gateway.read.channels.swrap_follower_angle_rad (i32, 13..14). Move one of the two.",
    ),
    "hole in the write block": (
        ("register: 108, complement: 109", "register: 109, complement: 110"),
        "109,",
        "gateway.write.corrections.swrap_follower.register: 1 word(s) between 107 and 109 would "
        "be written but are not ours. Move it to wire address 108.",
    ),
    "read block too long": (
        (
            "swrap_follower_angle_rad:\n        { register: 13",
            "swrap_follower_angle_rad:\n        { register: 200",
        ),
        "200",
        "gateway.read.channels.swrap_follower_angle_rad.register: the read block spans 202 words, "
        "125 fit one request.",
    ),
    "address above the wire": (
        ("roll_id: { register: 8 }", "roll_id: { register: 65536 }"),
        "65536",
        "gateway.read.roll_id.register: wire address 65536 does not exist (0..65535).",
    ),
    "unknown channel": (
        ("signal: unwind_tension_N,", "signal: unwind_tensoin_N,"),
        "unwind_tensoin_N,",
        "actuators.unwind.error.signal: unwind_tensoin_N is no channel of gateway.read. "
        "Did you mean unwind_tension_N?",
    ),
    "channel in another unit": (
        ("reference: tension_ref_N", "reference: line_speed_m_s"),
        "line_speed_m_s",
        "actuators.unwind.error.reference: line_speed_m_s is in m/s. Name a channel in N.",
    ),
    "angle in another unit": (
        ("angle: unwind_angle_rad", "angle: unwind_radius_m"),
        "unwind_radius_m\n",
        "rolls.unwind.angle: unwind_radius_m is in m. Name a channel in rad.",
    ),
    "unknown roll": (
        ("{ roll: unwind, orders", "{ roll: unwnid, orders"),
        "unwnid",
        "actuators.unwind.blocks[0].roll: unwnid is no roll. Did you mean unwind?",
    ),
    "order twice": (
        ("orders: [1, 2, 3, 4]", "orders: [1, 2, 3, 2]"),
        "2]",
        "actuators.unwind.blocks[0].orders[3]: order 2 of unwind is already in blocks[0]",
    ),
    "fewer than five counts": (
        ("amp_limit_m_s: 0.02", "amp_limit_m_s: 0.00004"),
        "0.00004",
        "actuators.unwind.blocks[0].amp_limit_m_s: 0.00004 m/s is 4 counts of the correction word "
        "(0.00001). Need >= 5: a finer scale or a higher limit.",
    ),
    "limit above the word": (
        ("    limit_m_s: 0.05", "    limit_m_s: 0.33"),
        "0.33",
        "actuators.unwind.limit_m_s: 0.33 m/s is 33000 counts of 0.00001; the word holds 32767.",
    ),
    "block above its actuator": (
        ("amp_limit_m_s: 0.02", "amp_limit_m_s: 0.06"),
        "0.06",
        "actuators.unwind.blocks[0].amp_limit_m_s: 0.06 m/s is above the actuator's limit 0.05",
    ),
    "limit in the other unit": (
        ("    slew_m_s2: 2.0", "    slew_N_m_s: 2.0"),
        "slew_N_m_s",
        "actuators.unwind.slew_N_m_s: the actuator's output is in m/s. Write slew_m_s2.",
    ),
    "zero too late": (
        ("fade_ms: 150", "fade_ms: 221"),
        "221",
        "freshness.fade_ms: fault_after_ms + fade_ms is 301 ms; zero is due within 300 ms.",
    ),
    "hold after fault": (
        ("hold_after_ms: 15", "hold_after_ms: 80"),
        "80\n",
        "freshness.hold_after_ms: is not below fault_after_ms 80 ms.",
    ),
    "deadline beyond the cycle": (
        ("#deadline_ms: 3.0", "deadline_ms: 5 ms"),
        "5 ms",
        "gateway.modbus_tcp.deadline_ms: 5 ms is not below cycle_ms 5 ms",
    ),
    "range in another unit": (
        ("min_m_s: -1, max_m_s: 10", "min_N: -1, max_m_s: 10"),
        "min_N: -1",
        "plausibility.line_speed_m_s.min_N: the channel is in m/s. Write min_m_s.",
    ),
    "range upside down": (
        ("min_m_s: -1, max_m_s: 10", "min_m_s: 5, max_m_s: 4"),
        "4",
        "plausibility.line_speed_m_s.max_m_s: 4 is not above the minimum 5.",
    ),
    "channel without a unit": (
        ("swrap_follower_speed_m_s: {", "swrap_follower_speed: {"),
        "swrap_follower_speed: {",
        "gateway.read.channels.swrap_follower_speed: the name does not end with its SI unit.",
    ),
    "bad name": (
        ("  swrap_follower:\n    angle", "  S-wrap:\n    angle"),
        "S-wrap",
        "rolls.S-wrap: S-wrap is no name. Begin with a small letter",
    ),
    "radius range upside down": (
        ("radius_max_m: 12 in", "radius_max_m: 3 in"),
        "3 in",
        "rolls.unwind.radius_max_m: 0.0762 m is not above radius_min_m 0.1016 m.",
    ),
    "two radii": (
        ("    #resets_on: never", "    radius: unwind_radius_m"),
        None,
        "rolls.swrap_follower: needs one of radius (a channel) and radius_m (a fixed radius).",
    ),
    "one response for two": (
        ("learned/euclid_swrap_follower.json", "learned/euclid_unwind.json"),
        None,
        "actuators.swrap_follower.response: learned/euclid_unwind.json is the response of unwind.",
    ),
    "permissive that is none": (
        ("need: [LINE_RUN,", "need: [SPLICE_ACTIVE,"),
        "SPLICE_ACTIVE",
        "permissives.need[0]: SPLICE_ACTIVE is not known here.",
    ),
    "newer version": (
        ("version: 1\n", "version: 2\n"),
        "2\n",
        "version: 2 is not known here. Write one of: 1.",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_bad_file_is_refused_at_the_exact_place(name, tmp_path):
    (old, new), needle, expected = CASES[name]
    path = edited(tmp_path, (old, new))
    with pytest.raises(ConfigError) as caught:
        load_site(path)
    line = next(line for line in str(caught.value).split("\n") if expected in line)
    if needle is not None:
        text = path.read_text(encoding="utf-8")
        start = text.index(new) + f"{new}\n".rindex(needle)
        row = text.count("\n", 0, start) + 1
        column = start - (text.rfind("\n", 0, start) + 1) + 1
        assert line.startswith(f"{path}:{row}:{column}  {expected}")


def test_one_position_counted_by_hand(tmp_path):
    path = tmp_path / "s.yaml"
    path.write_text("version: 1\nline: { name: L, cycle_ms: 1e1 }\nlimits: 3\n")
    with pytest.raises(ConfigError) as caught:
        load_site(path)
    lines = [line.removeprefix(str(path)) for line in str(caught.value).split("\n")]
    assert lines[:2] == [
        ":1:1  gateway: required key is missing. The connection to the PLC and the register map.",
        ":1:1  permissives: required key is missing. Status bits without which no correction "
        "goes out.",
    ]
    assert ':2:28  line.cycle_ms: "1e1" is text, not a number (YAML 1.1). Write 10.' in lines
    assert lines[-1].startswith(":3:1  limits: unknown key.")


def test_missing_key_is_named_at_its_section(tmp_path):
    path = edited(tmp_path, ("  word_order: high_first\n", ""))
    with pytest.raises(ConfigError) as caught:
        load_site(path)
    where = place(path, "gateway:")
    assert str(caught.value).startswith(
        f"{path}:{where}  gateway.word_order: required key is missing. Which word"
    )


def test_actuator_without_a_correction_word_is_refused(tmp_path):
    old = "      swrap_follower: { register: 108, complement: 109, scale: 0.00001 }\n"
    path = edited(tmp_path, (old, ""))
    with pytest.raises(ConfigError, match=r"actuators\.swrap_follower: swrap_follower has no"):
        load_site(path)


def test_error_signal_without_a_believable_range_is_refused(tmp_path):
    old = "  pullroll_tension_N: { min_N: 1, max_N: 400, stuck_after_s: 1.0 }\n"
    path = edited(tmp_path, (old, ""))
    with pytest.raises(ConfigError, match=r"plausibility: pullroll_tension_N has no believable"):
        load_site(path)


@pytest.mark.parametrize(
    ("written", "shown"),
    [(r'"a\nb"', r"a\nb"), (r'"\e[2J"', r"\x1b[2J"), (r'"\u2028"', r"\u2028")],
)
def test_control_characters_of_the_file_stay_out_of_the_message(written, shown, tmp_path):
    path = edited(tmp_path, ("version: 1\n", f"version: {written}\n"))
    with pytest.raises(ConfigError) as caught:
        load_site(path)
    assert str(caught.value).splitlines() == [
        f"{path}:{place(path, 'version:', 9)}  version: {shown} is not a whole number. Allowed: 1."
    ]


def test_misspelling_is_said_once_not_also_as_missing(tmp_path):
    path = edited(tmp_path, ("settle_s: 6,", "setle_s: 6,"))
    with pytest.raises(ConfigError) as caught:
        load_site(path)
    assert len(str(caught.value).split("\n")) == 1


def test_all_findings_come_together(tmp_path):
    path = edited(
        tmp_path,
        ("port: 5020", "port: 0"),
        ("settle_s: 6,", "settle_s: 0,"),
        ("max_MB: 500", "max_MB: 5 kg"),
    )
    with pytest.raises(ConfigError) as caught:
        load_site(path)
    assert len(str(caught.value).split("\n")) == 3


def test_shipped_file_is_clean_but_for_its_one_crossing():
    reading = read_site(EUCLID)
    assert [finding.path for finding in reading.warnings] == ["actuators.unwind.blocks"]
    assert "unwind 1x meets swrap_follower 1x at radius 0.1537 m" in reading.warnings[0].text


def test_site_gives_si_numbers():
    site = load_site(EUCLID)
    assert site.cycle_s == 0.005
    assert site.speed_max_m_s == pytest.approx(300 * 0.3048 / 60)
    assert site.rolls["unwind"].smallest_radius_m == pytest.approx(0.1016)
    assert site.rolls["unwind"].largest_radius_m == pytest.approx(0.3048)
    assert site.rolls["swrap_follower"].smallest_radius_m == 0.15367
    unwind = site.actuators["unwind"]
    assert (unwind.limit, unwind.slew, unwind.unit) == (0.05, 2.0, "m/s")
    assert unwind.blocks[0].amp_limit == 0.02
    channels = site.gateway.read.channels
    assert channels["unwind_radius_m"].scale == pytest.approx(2e-5)
    assert channels["unwind_angle_rad"].scale * 4096 == pytest.approx(2 * math.pi)
    assert site.plausibility["unwind_tension_N"].low == 1.0
    assert site.plausibility["line_speed_m_s"].high == 10.0


def test_plant_units_give_the_same_site(tmp_path):
    path = edited(
        tmp_path,
        ("    limit_m_s: 0.05", "    limit_m_s: 3 m/min"),
        ("scale: 0.02 mm", "scale: 0.00002"),
        ("hold_after_ms: 15", "hold_after_ms: 0.015 s"),
    )
    site = load_site(path)
    assert site.actuators["unwind"].limit_m_s == pytest.approx(0.05)
    assert site.gateway.read.channels["unwind_radius_m"].scale == pytest.approx(2e-5)
    assert site.freshness.hold_after_ms == pytest.approx(15.0)


@pytest.mark.parametrize(
    ("base", "register", "wire"),
    [
        (0, 0, 0),
        (0, 40001, 40001),
        (1, 1, 0),
        (1, 101, 100),
        (1, 40001, 0),
        (1, 40101, 100),
        (1, 400001, 0),
        (1, 465536, 65535),
        (1, 50000, 49999),
        (1, 0, -1),
    ],
)
def test_register_number_becomes_its_wire_address(base, register, wire):
    gateway = load_site(EUCLID).gateway.model_copy(update={"address_base": base})
    assert gateway.wire_address(register) == wire


def _keys(node, path=()):
    for name, inner in node.items():
        yield (*path, name)
        if isinstance(inner, dict):
            yield from _keys(inner, (*path, name))


@pytest.mark.parametrize("path", list(_keys(yaml.safe_load(EUCLID.read_text()))), ids=".".join)
def test_every_misspelt_key_of_the_shipped_file_is_refused(path, tmp_path):
    values = yaml.safe_load(EUCLID.read_text(encoding="utf-8"))
    node = values
    for part in path[:-1]:
        node = node[part]
    wrong = path[-1][:-2] + path[-1][-1] + path[-1][-2]
    if wrong == path[-1]:
        wrong = path[-1][:-1]
    node[wrong] = node.pop(path[-1])
    file = tmp_path / "site.yaml"
    file.write_text(yaml.safe_dump(values, sort_keys=False), encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        load_site(file)
    assert "Did you mean" in str(caught.value) or "does not end with its SI unit" in str(
        caught.value
    )


@pytest.mark.parametrize("index", range(3))
@pytest.mark.parametrize("name", ["roll", "orders", "settle_s", "amp_limit_m_s"])
def test_every_misspelt_block_key_is_refused_with_the_right_one(index, name, tmp_path):
    values = yaml.safe_load(EUCLID.read_text(encoding="utf-8"))
    blocks = [block for part in values["actuators"].values() for block in part["blocks"]]
    blocks[index][name + "x"] = blocks[index].pop(name)
    file = tmp_path / "site.yaml"
    file.write_text(yaml.safe_dump(values, sort_keys=False), encoding="utf-8")
    with pytest.raises(ConfigError, match=rf"unknown key\. Did you mean {name}\?"):
        load_site(file)


_TOKENS = st.sampled_from(
    [
        "1e-3",
        ".nan",
        "-.inf",
        "nan",
        "inf",
        "1e400",
        "0,5",
        "[]",
        "{}",
        "~",
        "yes",
        "!!x",
        "&a",
        "*a",
        "<<: *b",
        "\t",
        ":",
        "#",
        "'",
        '"',
        "99999999999999999999",
        "-1",
        "0",
        "3 lbf",
        "\x00",
        "é",
        "- ",
        "{ a: 1 }",
        "0x10",
        "1:30",
        "unwind",
        "line_speed_m_s",
    ]
)
_TEXT = EUCLID.read_text(encoding="utf-8")
_BARE = "\n".join(line for line in _TEXT.split("\n") if not line.lstrip().startswith("#"))


@settings(max_examples=250, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_random_edits_give_a_finite_site_or_a_config_error(data, tmp_path_factory):
    text = _BARE
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        length = data.draw(st.sampled_from([0, 1, 3, 10, 60]))
        text = text[:start] + data.draw(_TOKENS) + text[start + length :]
    path = tmp_path_factory.mktemp("fuzz") / "site.yaml"
    path.write_text(text, encoding="utf-8")
    _assert_finite_or_refused(path)


@settings(max_examples=250, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_random_values_give_a_finite_site_or_a_config_error(data, tmp_path_factory):
    values = yaml.safe_load(_TEXT)
    for _ in range(data.draw(st.integers(1, 2))):
        node = values
        while True:
            places = list(node) if isinstance(node, dict) else list(range(len(node)))
            if not places:
                break
            name = data.draw(st.sampled_from(places))
            inner = node[name]
            if not isinstance(inner, dict | list) or data.draw(st.integers(0, 4)) == 0:
                node[name] = data.draw(_VALUES)
                break
            node = inner
    path = tmp_path_factory.mktemp("fuzz") / "site.yaml"
    path.write_text(yaml.safe_dump(values, sort_keys=False), encoding="utf-8")
    _assert_finite_or_refused(path)


_VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=8),
    st.sampled_from(["unwind", "unwind_radius_m", "3 lbf", "1 m/s", "u16", "i32", [], {}, [1, 2]]),
    st.lists(st.integers(-2, 70), max_size=4),
)


def _assert_finite_or_refused(path):
    try:
        site = load_site(path)
    except ConfigError as error:
        _assert_every_line_has_a_place(str(error), path)
        return
    for leaf in leaves(site):
        if isinstance(leaf.value, float):
            assert math.isfinite(leaf.value), leaf.path


def _assert_every_line_has_a_place(said, path):
    assert all(line.startswith(f"{path}:") for line in said.split("\n"))
