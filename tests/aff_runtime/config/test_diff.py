"""Differences of two sites, and which may go in while a correction is active."""

import pytest

from aff_runtime.config.diff import diff_sites, may_apply_while_active
from aff_runtime.config.loader import load_site
from tests.aff_runtime.config.shipped import EUCLID, edited


def changes(tmp_path, *edits):
    return diff_sites(load_site(EUCLID), load_site(edited(tmp_path, *edits)))


def test_same_content_written_otherwise_is_no_difference(tmp_path):
    rewritten = (
        ("#deadline_ms: 3.0", "deadline_ms: 3"),
        ("soft_start_s: 1.5", "soft_start_s: 1500 ms"),
        ("# Where corrections go in.", "# another comment"),
    )
    assert changes(tmp_path, *rewritten) == ()


@pytest.mark.parametrize(
    ("edit", "line"),
    [
        (
            ("settle_s: 6,", "settle_s: 0.2 min,"),
            "actuators.unwind.blocks[0].settle_s: 6 s -> 12 s (applies at once)",
        ),
        (
            ("amp_limit_m_s: 0.02", "amp_limit_m_s: 0.01"),
            "actuators.unwind.blocks[0].amp_limit_m_s: 0.02 m/s -> 0.01 m/s (applies at once)",
        ),
        (
            ("    limit_m_s: 0.05", "    limit_m_s: 0.06"),
            "actuators.unwind.limit_m_s: 0.05 m/s -> 0.06 m/s (applies at once)",
        ),
        (
            ("orders: [1, 2, 3, 4]", "orders: [1, 2]"),
            "actuators.unwind.blocks[0].orders: [1, 2, 3, 4] -> [1, 2] (applies at once)",
        ),
        (
            ("settle_s: 10, ", "settle_s: 10, enabled: false, "),
            "actuators.unwind.blocks[1].enabled: true -> false (applies at once)",
        ),
        (("cycle_ms: 5\n", "cycle_ms: 10\n"), "line.cycle_ms: 5 ms -> 10 ms (waits for bypass)"),
        (
            ("host: 127.0.0.1", "host: 127.0.0.2"),
            "gateway.modbus_tcp.host: 127.0.0.1 -> 127.0.0.2 (waits for bypass)",
        ),
        (
            ("type: u16, scale: 0.01 }", "type: u16, scale: 0.1 }"),
            "gateway.read.channels.tension_ref_N.scale: 0.01 -> 0.1 (waits for bypass)",
        ),
        (
            ("radius_m: 0.15367", "radius_m: 6 in"),
            "rolls.swrap_follower.radius_m: 0.15367 m -> 0.1524 m (waits for bypass)",
        ),
        (
            ("roll_id: { register: 8 }", "roll_id: { register: 18 }"),
            "gateway.read.roll_id.register: 8 -> 18 (waits for bypass)",
        ),
        (
            ("fade_ms: 150", "fade_ms: 100"),
            "freshness.fade_ms: 150 ms -> 100 ms (waits for bypass)",
        ),
    ],
)
def test_change_is_one_readable_line(edit, line, tmp_path):
    (change,) = changes(tmp_path, edit)
    assert str(change) == line
    assert may_apply_while_active((change,)) is line.endswith("(applies at once)")


BLOCK = "      - { roll: swrap_follower, orders: [1], settle_s: 10, amp_limit_m_s: 0.01 }\n"


def test_a_whole_block_that_appears_or_goes_applies_at_once(tmp_path):
    gone = changes(tmp_path, (BLOCK, ""))
    assert {change.new for change in gone} == {"(absent)"}
    assert may_apply_while_active(gone)
    back = diff_sites(load_site(edited(tmp_path, (BLOCK, ""))), load_site(EUCLID))
    assert {change.old for change in back} == {"(absent)"}
    assert may_apply_while_active(back)


def test_a_whole_roll_that_appears_or_goes_applies_at_once_and_its_keys_do_not(tmp_path):
    last = "    radius_m: 0.15367\n"
    more = (last, f"{last}  r5: {{ radius_m: 0.0381 }}\n")
    with_roll = changes(tmp_path, more)
    assert "rolls.r5.radius_m" in {change.path for change in with_roll}
    assert may_apply_while_active(with_roll)
    with_speed = (last, f"{last}    line_speed: swrap_follower_speed_m_s\n")
    assert not may_apply_while_active(changes(tmp_path, with_speed))


def test_of_a_new_roll_only_what_is_given_is_told(tmp_path):
    added = ("rolls:\n", "rolls:\n  r9: { radius_m: 38.1 mm }\n")
    assert [str(one) for one in changes(tmp_path, added)] == [
        "rolls.r9.radius_m: (absent) -> 0.0381 m (applies at once)",
        "rolls.r9.resets_on: (absent) -> never (applies at once)",
    ]
    old, new = load_site(edited(tmp_path, added)), load_site(EUCLID)
    assert {one.old for one in diff_sites(old, new)} == {"0.0381 m", "never"}


def test_a_block_of_another_roll_in_the_place_of_one_waits_for_bypass(tmp_path):
    assert not may_apply_while_active(
        changes(tmp_path, (BLOCK, BLOCK.replace("swrap_follower", "unwind").replace("[1]", "[9]")))
    )


def test_another_order_of_channels_is_a_difference_that_waits(tmp_path):
    one = "      tension_ref_N: { register: 4, type: u16, scale: 0.01 }\n"
    two = "      line_speed_m_s: { register: 5, type: i16, scale: 0.001 }\n"
    (change,) = changes(tmp_path, (one + two, two + one))
    assert change.path == "gateway.read.channels (order)"
    assert not change.may_change_while_active
