"""What keys must be to each other, where it only warns, and where a limit is exact."""

import math

import pytest

from aff_runtime.app.wiring.site_to_law import site_params
from aff_runtime.base.errors import ConfigError
from aff_runtime.config.loader import load_site, read_site
from tests.aff_runtime.config.shipped import edited

ENCODER = "type: i32, scale: 4096 counts/turn, wraps: true }"


def warnings_of(path):
    return {finding.path: finding.text for finding in read_site(path).warnings}


def test_too_few_samples_per_turn_is_a_warning_with_the_speed_that_still_works(tmp_path):
    path = edited(tmp_path, ("speed_max_m_s: 300 FPM", "speed_max_m_s: 2"))
    said = warnings_of(path)["actuators.unwind.blocks[0].orders[3]"]
    # 4 * 2 / (2 pi 0.1016) = 12.53 Hz, 1 / (12.53 * 0.005) = 15.96; 2 * 15.96 / 20 = 1.6
    assert "order 4 has 16.0 samples per period at 2 m/s and radius 0.1016 m (12.53 Hz)" in said
    assert "nothing above 10 Hz at a cycle of 5 ms: stay under 1.6 m/s" in said
    output = "    output: velocity_reference\n"
    path.write_text(path.read_text().replace(output, f"{output}    law: shape\n", 1))
    said = warnings_of(path)["actuators.unwind.blocks[0].orders[3]"]
    assert "it stands in until the drive is known: probe, or declare drive; else stay" in said


def test_plausible_maximum_stands_in_for_a_missing_highest_speed(tmp_path):
    path = edited(tmp_path, ("  speed_max_m_s: 300 FPM\n", ""))
    assert load_site(path).speed_max_m_s == 10.0
    assert "at 10 m/s" in warnings_of(path)["actuators.unwind.blocks[0].orders[3]"]


@pytest.mark.parametrize(("limit", "accepted"), [("0.00005", True), ("0.0000499", False)])
def test_five_counts_are_enough_and_less_is_not(limit, accepted, tmp_path):
    path = edited(tmp_path, ("amp_limit_m_s: 0.02", f"amp_limit_m_s: {limit}"))
    if accepted:
        load_site(path)
    else:
        with pytest.raises(ConfigError, match="counts of the correction word"):
            load_site(path)


@pytest.mark.parametrize(("limit", "accepted"), [("0.32767", True), ("0.32768", False)])
def test_limit_may_fill_the_word_but_not_more(limit, accepted, tmp_path):
    path = edited(tmp_path, ("    limit_m_s: 0.05", f"    limit_m_s: {limit}"))
    if accepted:
        load_site(path)
    else:
        with pytest.raises(ConfigError, match="the word holds 32767"):
            load_site(path)


def test_stale_to_zero_may_take_300_ms_and_not_more(tmp_path):
    load_site(edited(tmp_path, ("fade_ms: 150", "fade_ms: 220")))
    with pytest.raises(ConfigError, match="zero is due within 300 ms"):
        load_site(edited(tmp_path, ("fade_ms: 150", "fade_ms: 220.5")))


def test_read_block_may_span_125_words_and_not_more(tmp_path):
    old = "swrap_follower_angle_rad:\n        { register: 13"
    load_site(edited(tmp_path, (old, old.replace("13", "123"))))
    with pytest.raises(ConfigError, match="spans 126 words, 125 fit"):
        load_site(edited(tmp_path, (old, old.replace("13", "124"))))


def test_read_holes_are_allowed(tmp_path):
    load_site(edited(tmp_path, ("roll_id: { register: 8 }", "roll_id: { register: 20 }")))


def test_rolls_with_a_common_frequency_at_every_speed_warn(tmp_path):
    path = edited(
        tmp_path,
        ("    radius: unwind_radius_m\n", "    radius_m: 0.30734\n"),
        ("    radius_min_m: 4 in\n    radius_max_m: 12 in\n", ""),
    )
    assert (
        "unwind 2x meets swrap_follower 1x always" in warnings_of(path)["actuators.unwind.blocks"]
    )


def test_short_hold_and_missing_permissives_warn(tmp_path):
    path = edited(
        tmp_path,
        ("hold_after_ms: 15", "hold_after_ms: 9"),
        ("need: [LINE_RUN, WEB_INTACT, TENSION_VALID, ESTOP_OK]", "need: [LINE_RUN]"),
    )
    said = warnings_of(path)
    assert "one late reply holds" in said["freshness.hold_after_ms"]
    assert "permissives.need" in said


def test_angle_that_does_not_wrap_warns(tmp_path):
    path = edited(tmp_path, (", wraps: true }", " }"))
    assert "Write wraps: true" in warnings_of(path)["gateway.read.channels.unwind_angle_rad"]


def test_manual_numbers_in_a_wire_base_warn(tmp_path):
    text = edited(tmp_path).read_text(encoding="utf-8")
    for number in [*range(109, 99, -1), *range(17, -1, -1)]:
        text = text.replace(f"register: {number} ", f"register: {40001 + number} ")
        text = text.replace(f"register: {number},", f"register: {40001 + number},")
        text = text.replace(f"complement: {number},", f"complement: {40001 + number},")
    path = tmp_path / "manual.yaml"
    path.write_text(text, encoding="utf-8")
    assert "write 1" in warnings_of(path)["gateway.address_base"]
    path.write_text(text.replace("address_base: 0", "address_base: 1"), encoding="utf-8")
    assert "gateway.address_base" not in warnings_of(path)
    assert load_site(path).gateway.wire_address(40101) == 100


CHANNELS = "      unwind_tension_N:"
TORQUE_WORD = "      roll_torque_N_m: { register: 20, type: i16, scale: 0.1 }\n"
TORQUE = "    torque: roll_torque_N_m\n"
BEFORE, AFTER = "    tension_before: unwind_tension_N\n", "    tension_after: pullroll_tension_N\n"


@pytest.mark.parametrize(
    ("roll", "keys", "at", "said"),
    [
        ("swrap_follower", TORQUE, ".torque", "nothing of it is known to be friction"),
        ("swrap_follower", AFTER, "", "Add torque"),
        ("swrap_follower", TORQUE + AFTER, ".torque", "Add tension_before"),
        ("swrap_follower", TORQUE + BEFORE, ".torque", "Add tension_after"),
        ("swrap_follower", TORQUE + BEFORE + AFTER, None, ""),
        ("unwind", TORQUE + AFTER, None, ""),  # on its other side it has no web
    ],
)
def test_a_drive_whose_friction_would_hold_something_else_warns(roll, keys, at, said, tmp_path):
    angle = f"    angle: {roll}_angle_rad\n"
    path = edited(tmp_path, (CHANNELS, TORQUE_WORD + CHANNELS), (angle, angle + keys))
    found = {at: text for at, text in warnings_of(path).items() if "friction" in text}
    assert found.keys() == (set() if at is None else {f"rolls.{roll}{at}"})
    assert all(said in text for text in found.values())


def test_torque_output_uses_torque_keys(tmp_path):
    path = edited(
        tmp_path,
        ("velocity_reference\n    error: { signal: p", "torque_reference\n    error: { signal: p"),
        ("limit_m_s: 0.04\n    slew_m_s2: 2.0", "limit_N_m: 20 lbf in\n    slew_N_m_s: 50"),
        ("settle_s: 8, amp_limit_m_s: 0.03", "settle_s: 8, amp_limit_N_m: 1"),
        ("complement: 109, scale: 0.00001", "complement: 109, scale: 1 mNm"),
        ("register: 17, scale: 0.00001", "register: 17, scale: 1 mNm"),
    )
    site = load_site(path)
    follower = site.actuators["swrap_follower"]
    assert follower.unit == "N m"
    assert follower.limit == pytest.approx(20 * 0.45359237 * 9.80665 * 0.0254)
    assert (follower.slew, follower.blocks[0].amp_limit) == (50.0, 1.0)
    assert site.gateway.write.corrections["swrap_follower"].scale == pytest.approx(0.001)


def test_velocity_scale_in_a_torque_unit_is_refused(tmp_path):
    path = edited(tmp_path, ("complement: 104, scale: 0.00001", "complement: 104, scale: 1 mNm"))
    with pytest.raises(ConfigError, match=r'unwind\.scale: "1 mNm" is a torque, expected a speed'):
        load_site(path)


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (("    limit_m_s: 0.05\n", ""), r"actuators\.unwind\.limit_m_s: required key is missing"),
        (("    slew_m_s2: 2.0\n", ""), r"actuators\.unwind\.slew_m_s2: required key is missing"),
        ((", amp_limit_m_s: 0.02", ""), r"blocks\[0\]\.amp_limit_m_s: required key is missing"),
        (("    radius_min_m: 4 in\n", ""), r"rolls\.unwind\.radius_min_m: required key"),
        (("min_m_s: -1, ", ""), r"plausibility\.line_speed_m_s\.min_m_s: required key is missing"),
        (("  line_speed_m_s: { min", "  unwind_angle_rad: { min"), r"an angle has no believable"),
        (("amplitude_m_s: 0.008", "amplitude_m_s: 0.045"), r"above the limit of swrap_follower"),
        (("type: u16, scale: 0.01 }", "type: u16, scale: 0.01, wraps: true }"), "Remove wraps"),
        (("fault_after_ms: 80", "fault_after_ms: 14"), r"is under three cycles"),
        (
            (ENCODER, "type: u16, scale: 0.1 deg, wraps_after: 3600 }"),
            r"wraps_after: needs wraps:",
        ),
        ((ENCODER, "type: u16, scale: 0.1 deg, wraps: true, wraps_after: 65537 }"), "u16 holds"),
        ((ENCODER, "type: u16, scale: 0.1 deg, wraps: true, wraps_after: 80 }"), "within a cycle"),
    ],
)
def test_key_that_another_key_asks_for(edit, said, tmp_path):
    with pytest.raises(ConfigError, match=said):
        load_site(edited(tmp_path, edit))


def test_an_axis_in_tenths_of_a_degree_starts_over_after_a_turn(tmp_path):
    axis = (ENCODER, "type: u16, scale: 0.1 deg, wraps: true, wraps_after: 3600 }")
    path = edited(tmp_path, axis)
    roll = site_params(load_site(path)).rolls[0]
    assert roll.angle_modulus_rad == pytest.approx(math.tau)


def test_order_of_corrections_follows_the_actuators(tmp_path):
    one = "      unwind: { register: 103, complement: 104, scale: 0.00001 }\n"
    two = "      swrap_follower: { register: 108, complement: 109, scale: 0.00001 }\n"
    with pytest.raises(ConfigError, match="the order differs from actuators"):
        load_site(edited(tmp_path, (one + two, two + one)))
