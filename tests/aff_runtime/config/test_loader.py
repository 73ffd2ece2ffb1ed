"""Bad site files: each message stands at the exact line and column and says what to do."""

import math

import pytest

from aff_runtime.base.errors import ConfigError
from aff_runtime.config.loader import load_site, read_site
from tests.aff_runtime.config.bad_sites import CASES
from tests.aff_runtime.config.shipped import EUCLID, edited, place


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


def test_a_line_declaration_is_refused_in_one_sentence(tmp_path):
    path = tmp_path / "line.yaml"
    path.write_text("schema: web-line-declaration/1\nrollers: []\n")
    with pytest.raises(ConfigError) as caught:
        load_site(path)
    assert str(caught.value) == (
        f"{path}:1:1  schema: this is a line declaration, which sim-plant reads. "
        "Give a site file, such as config/euclid.yaml."
    )


def test_actuator_without_a_correction_word_is_refused(tmp_path):
    old = "      swrap_follower: { register: 108, complement: 109, scale: 0.00001 }\n"
    path = edited(tmp_path, (old, ""))
    with pytest.raises(ConfigError, match=r"actuators\.swrap_follower: swrap_follower has no"):
        load_site(path)


def test_error_signal_without_a_believable_range_is_refused(tmp_path):
    old = "  pullroll_tension_N: { min_N: 1, max_N: 400, stuck_after_s: 0.1 }\n"
    path = edited(tmp_path, (old, ""))
    with pytest.raises(ConfigError, match=r"plausibility: pullroll_tension_N has no believable"):
        load_site(path)


@pytest.mark.parametrize(
    ("written", "shown"), [(r'"\u2029"', r"\u2029"), (r'"\u2028"', r"\u2028")]
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


def test_shipped_file_is_clean_but_for_its_plain_wire_and_its_one_meeting():
    wire, meeting = read_site(EUCLID).warnings
    assert (wire.path, meeting.path) == ("gateway.modbus_tcp", "actuators.unwind.blocks")
    assert "nothing on this wire is encrypted or signed" in wire.text
    assert "unwind 1x meets swrap_follower 1x at radius 0.1537 m" in meeting.text


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
