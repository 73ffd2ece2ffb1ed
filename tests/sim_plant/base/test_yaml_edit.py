"""An edited YAML text: what was not changed is the owner's, to the byte."""

import difflib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim_plant.base.yaml_edit import lost_comments, with_keys, with_values
from tests import quick_yaml

OWN = """\
# my line, measured in May
name: "web 3"   # quoted as I like it
flag: yes
nothing: null
numbers: [1.0e-3, 2,   3.50]
long: 'a text that its owner has folded in two lines, as long texts in line files of many words and
  more words mostly are'
corrections:   # put right
  # from the calibration
  web.EA_N: 0.010  # +- 0.002
  # none of the others
effects: []  # none known yet
# what follows is drawn to scale
rollers:
  - name: R1   # the first
    radius_m: 0.0381
  - name: R2
    # re-ground in June
    radius_m: 0.0380
# end of file
"""


def edited(lines, **changes):
    """Return the lines that a change takes away, and those that it puts in."""
    found = with_keys(lines, changes).splitlines()
    diff = [x for x in difflib.ndiff(lines.splitlines(), found) if x[0] in "+-"]
    return [x[2:] for x in diff if x[0] == "-"], [x[2:] for x in diff if x[0] == "+"]


def comments(text):
    return [line[line.index("#") :] for line in text.splitlines() if "#" in line]


def test_nothing_changed_is_the_same_text():
    assert with_keys(OWN, {}) == OWN


def test_a_new_key_comes_last_and_nothing_else_is_touched():
    assert edited(OWN, provenance={"made_by": "x", "size_m": 1e-5}) == (
        [],
        ["provenance:", "  made_by: x", "  size_m: 1.0e-05"],
    )


def test_one_number_in_a_mapping_is_changed_where_it_stands():
    gone, new = edited(OWN, corrections={"web.EA_N": 0.02, "web.thickness_m": -0.5})
    assert gone == ["  web.EA_N: 0.010  # +- 0.002"]
    assert new == ["  web.EA_N: 0.02   # +- 0.002", "  web.thickness_m: -0.5"]


def test_an_empty_list_that_gets_entries_keeps_what_was_said_beside_and_below_it():
    found = with_keys(OWN, {"effects": [{"effect": "slip", "location": "R1"}]})
    assert comments(found) == comments(OWN)
    assert found.index("location: R1") < found.index("# what follows is drawn to scale")
    assert quick_yaml.safe_load(found)["effects"] == [{"effect": "slip", "location": "R1"}]


def test_entries_of_a_list_keep_their_comments_when_more_are_added():
    rollers = [*quick_yaml.safe_load(OWN)["rollers"], {"name": "R3", "radius_m": 0.05}]
    rollers[0]["radius_m"] = 0.04
    gone, new = edited(OWN, rollers=rollers)
    assert gone == ["    radius_m: 0.0381"]
    assert new == ["    radius_m: 0.04", "  - name: R3", "    radius_m: 0.05"]


@pytest.mark.parametrize(
    "value", ["yes", "1e-3", "2026-01-01", "0o17", "null", "12:30", "# no", ""]
)
def test_a_text_that_yaml_1_1_would_take_for_something_else_is_quoted(value):
    found = with_keys(OWN, {"provenance": {"made_by": value}, "corrections": {value or "x": 1e-7}})
    data = quick_yaml.safe_load(found)
    assert data["provenance"] == {"made_by": value}
    assert data["corrections"] == {value or "x": 1e-7}


def test_what_is_named_elsewhere_too_stays_as_it_is_there():
    text = "first: &own {size_m: 1.0}\nsecond: *own\n"
    found = quick_yaml.safe_load(with_keys(text, {"first": {"size_m": 2.0}}))
    assert found == {"first": {"size_m": 2.0}, "second": {"size_m": 1.0}}


CHANGES = {"corrections": {"web.EA_N": 0.010, "web.thickness_m": -0.5}, "made": {"by": "x"}}


@pytest.mark.parametrize("end", ["\r\n", "\r"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_lines_end_as_the_owners_do(end, mark):
    found = with_keys(mark + OWN.replace("\n", end), CHANGES)
    assert found == mark + with_keys(OWN, CHANGES).replace("\n", end)
    assert comments(found.replace(end, "\n")) == comments(OWN)


def test_each_line_of_the_owners_keeps_an_end_of_its_own():
    """A file that two editors wrote: new lines end as most do."""
    lines = OWN.splitlines()
    mixed = [line + ("\r\n" if k % 3 else "\n") for k, line in enumerate(lines)]
    found = with_keys("".join(mixed), CHANGES).splitlines(keepends=True)
    assert [line for line in found if line in mixed] == mixed
    new = [line for line in found if line not in mixed]
    assert new == ["  web.thickness_m: -0.5\r\n", "made:\r\n", "  by: x\r\n"]


def test_a_last_line_without_an_end_gets_one_when_others_follow():
    text = "a: 1  # one\nb:\n  - x: 1  # two"
    found = with_keys(text, {"b": [{"x": 1}, {"x": 2}]})
    assert found.splitlines() == [*text.splitlines(), "  - x: 2"]
    assert with_keys(text, {"a": 3}) == text.replace("a: 1 ", "a: 3 ")


def test_what_has_an_anchor_is_changed_at_its_place_where_nobody_else_sees_it():
    text = "a: &own  # ours\n  # inside\n  size_m: 1.0  # one\n  kept: 2  # two\nb: 3  # three\n"
    assert with_keys(text, {"a": {"size_m": 2.0, "kept": 2}}) == text.replace("1.0", "2.0")
    # who takes the rest of it and has a size of its own sees nothing either
    merged = text + "c:\n  <<: *own  # the rest\n  size_m: 7.0  # mine\n"
    found = with_keys(merged, {"a": {"size_m": 2.0, "kept": 2}})
    assert found == merged.replace("1.0", "2.0")


def test_comments_that_a_text_no_longer_has_are_named():
    assert lost_comments(OWN, OWN.replace("\n", "\r\n")) == []
    assert lost_comments("a: 1  # x\n# y\n# y\nb: p#q\n", "a: 2 # x\n  # y\n") == ["# y"]
    assert len(lost_comments(OWN, "")) == len(comments(OWN))


@pytest.mark.parametrize(
    ("own", "changes"),
    [
        (OWN, {"corrections": [{}, 0.0, []]}),  # a comment would become part of the 0.0
        ('a: "\\/"\nb: !!binary aGk=\nc: 0b11\n', {"b": 1}),
    ],
)
def test_values_come_before_comments(own, changes):
    assert quick_yaml.safe_load(with_keys(own, changes)) == quick_yaml.safe_load(own) | changes


def test_a_removed_entry_is_gone():
    found = with_keys(OWN, {"rollers": [{"name": "R1", "radius_m": 0.0381}]})
    assert quick_yaml.safe_load(found)["rollers"] == [{"name": "R1", "radius_m": 0.0381}]


WORDS = st.text("abyesno:#-1. ", max_size=8)
NUMBERS = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-9, 9)
PLAIN = st.recursive(
    NUMBERS | WORDS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(WORDS, inner, max_size=3),
    max_leaves=6,
)


@settings(max_examples=20, deadline=None)
@given(st.dictionaries(st.sampled_from(["corrections", "effects", "rollers", "new"]), PLAIN))
def test_whatever_is_put_in_is_read_back_and_all_else_is_as_it_was(changes):
    assert quick_yaml.safe_load(with_keys(OWN, changes)) == quick_yaml.safe_load(OWN) | changes


ENTRY = st.fixed_dictionaries(
    {"effect": WORDS, "location": WORDS},
    optional={"parameters": st.dictionaries(WORDS, NUMBERS | WORDS, min_size=1, max_size=3)},
)


@settings(max_examples=20, deadline=None)
@given(st.dictionaries(WORDS, NUMBERS, max_size=3), st.lists(ENTRY, min_size=1, max_size=3))
def test_corrections_and_effects_leave_every_comment_in_its_place(corrections, effects):
    changes = {"corrections": {"web.EA_N": 0.02, **corrections}, "effects": effects}
    found = with_keys(OWN, changes)
    assert quick_yaml.safe_load(found) == quick_yaml.safe_load(OWN) | changes
    own = [line for line in found.splitlines() if line in OWN.splitlines()]
    assert set(OWN.splitlines()) - set(own) == {
        "  web.EA_N: 0.010  # +- 0.002",
        "effects: []  # none known yet",
    }
    kept = [c for c in comments(found) if c in comments(OWN)]
    assert kept == comments(OWN)


def test_a_value_at_a_path_leaves_all_else_as_it_was_written():
    text = "a:\n  b:\n    c: 1.50 # ours\n    d: 2.50\n  e: 0x10\n# below\nf: yes\n"
    found = with_values(text, {("a", "b", "c"): 3.25, ("f",): "no"})
    assert found == text.replace("1.50", "3.25").replace("yes", "'no'")


def test_a_path_without_a_mapping_is_named():
    with pytest.raises(KeyError, match=r"a\.b"):
        with_values("a: { b: 1 }\n", {("a", "b", "c"): 2})
