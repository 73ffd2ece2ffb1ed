"""Keys that a site file leaves to their default, added to its text: only their lines are new."""

from __future__ import annotations

import pytest
import yaml

from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.config.edited_text import EditedText
from aff_runtime.config.leaves import leaves
from aff_runtime.config.loader import load_site
from tests.each_case import each_case
from tests.parameter_records import CONFIG

TEXT = """\
# of the line
line:
  # Name on screens.
  name: Euclid
  # Channel with the speed.
  #speed: line_speed_m_s
  # Highest speed.
  max: 300 FPM # of the plant

probe: { amplitude: 0.02 } # loud
base: &base { settle_s: 6 }
one: *base
two:
  - roll: unwind
    orders: [1]
    #start: none
  - { roll: nip, orders: [1] }
empty: {}
last:
  a:
    b: 1
"""


@each_case(
    ("path", "new", "before", "after"),
    [
        (("line", "speed"), "v_m_s", "  #speed: line_speed_m_s\n", "  speed: v_m_s\n"),
        (("line", "cycle_ms"), "10", "  name: Euclid\n", "  cycle_ms: 10\n"),
        (("probe", "offset_Hz"), "0.2 Hz", "probe: { ", "offset_Hz: 0.2 Hz, "),
        (("two", 0, "start"), "[1, 2]", "    #start: none\n", "    start: [1, 2]\n"),
        (("two", 0, "settle_s"), "5", "  - roll: unwind\n", "    settle_s: 5\n"),
        (("two", 1, "settle_s"), "5", "  - { ", "settle_s: 5, "),
        (("two", 1, "error", "noise"), "5", "  - { ", "error: { noise: 5 }, "),
        (("last", "a", "c"), "5", "  a:\n", "    c: 5\n"),
        (("last", "d", "e", "f"), "5", "last:\n", "  d:\n    e:\n      f: 5\n"),
        (("recording", "max_MB"), "300", "empty: {}\n", "recording:\n  max_MB: 300\n"),
    ],
)
def test_a_key_stands_below_its_comment_or_beside_the_others(path, new, before, after) -> None:
    edited = EditedText(TEXT)
    assert edited.can_add(path)
    changed = edited.with_values({path: new})
    assert changed == TEXT.replace(before, before + after, 1)
    value = yaml.safe_load(changed)
    for part in path:
        value = value[part]
    assert str(value) == new


@each_case(
    "path", [("one", "x"), ("base", "x"), ("empty", "x"), ("two", 2, "x"), ("line", "name", "x")]
)
def test_where_no_place_shows_it_is_told_so(path) -> None:
    assert not EditedText(TEXT).can_add(path)
    with pytest.raises(ConfigError, match="write it into the site file first"):
        EditedText(TEXT).with_values({path: "1"})


@each_case("new", ["", "1, y: 2", "5 # five", "{a: 1}", "5\nline: 6", "[1"])
def test_what_is_no_single_value_is_not_added(new) -> None:
    with pytest.raises(RefusedError):
        EditedText(TEXT).with_values({("line", "cycle_ms"): new})


def test_line_ends_and_the_order_mark_of_the_file_are_kept() -> None:
    text = "\ufeff" + TEXT.replace("\n", "\r\n")
    changed = EditedText(text).with_values({("line", "cycle_ms"): "10", ("line", "max"): "200"})
    wanted = text.replace("Euclid\r\n", "Euclid\r\n  cycle_ms: 10\r\n")
    assert changed == wanted.replace("300 FPM", "200")


def test_a_file_that_does_not_end_its_last_line_takes_a_key_above_it() -> None:
    assert EditedText("a:\n  b: 1").with_values({("a", "c"): "2"}) == "a:\n  c: 2\n  b: 1"


def test_a_comment_at_the_end_of_the_file_takes_its_key_below() -> None:
    text = "a:\n  b: 1\n  #c: 5"
    assert EditedText(text).with_values({("a", "c"): "2"}) == "a:\n  b: 1\n  #c: 5\n  c: 2\n"


def test_another_sections_comment_is_not_taken() -> None:
    text = "a:\n  b: 1\nd:\n  #c: 5\n  e: 1\n"
    assert EditedText(text).with_values({("a", "c"): "2"}) == text.replace("a:\n", "a:\n  c: 2\n")


@pytest.mark.parametrize("name", ["euclid.yaml", "euclid_blocks.yaml", "film.yaml"])
def test_each_key_that_a_shipped_site_leaves_out_is_added_without_another_change(name) -> None:
    text = (CONFIG / name).read_text(encoding="utf-8")
    edited, site = EditedText(text), load_site(CONFIG / name)
    numbers = [one for one in leaves(site) if not one.given and isinstance(one.value, float | int)]
    paths = [one.path for one in numbers if edited.can_add(one.path)]
    assert len(paths) > 10
    for path in paths:
        changed = edited.with_values({path: "1"})
        added = [one for one in changed.split("\n") if one.strip() == f"{path[-1]}: 1"]
        if added:
            lines = changed.split("\n")
            lines.remove(added[0])
            kept = "\n".join(lines)
        else:
            kept = changed.replace(f"{path[-1]}: 1, ", "", 1)
        assert kept == text, path
