"""The strict reader: every trap of YAML 1.1 is refused at its line and column."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.base.errors import ConfigError
from aff_runtime.config.yaml_marks import MAX_BYTES, parse_marked, read_marked
from tests.each_case import each_case


def assert_every_line_has_a_place(said):
    assert all(line.startswith("f:") for line in said.split("\n"))


def refused(text):
    raw = text if isinstance(text, bytes) else text.encode()
    with pytest.raises(ConfigError) as caught:
        parse_marked(raw, "site.yaml")
    return str(caught.value).split("\n")


@each_case(
    ("text", "expected"),
    [
        ("a: 1\nb: 2\na: 3\n", "site.yaml:3:1  a: key stands twice, first in line 1."),
        ("x: { a: 1, a: 2 }\n", "site.yaml:1:12  x.a: key stands twice, first in line 1."),
        ("a:\n\tb: 1\n", "site.yaml:2:1  a tab indents this line."),
        ("a:\n  \tb: 1\n", "site.yaml:2:3  a tab indents this line."),
        ("a: { b: 0,05, c: 1 }\n", 'site.yaml:1:9  a.b: "0,05" has a decimal comma. Write 0.05.'),
        ("t: 1:30\n", "site.yaml:1:4  t: 1:30 is a base-60 number in YAML 1.1."),
        ("r: 010\n", "site.yaml:1:4  r: 010 is an octal number in YAML 1.1. Write 10."),
        ("r: 1_000\n", "site.yaml:1:4  r: 1_000 has underscores. Write 1000."),
        ("r: .nan\n", "site.yaml:1:4  r: .nan is not a finite number."),
        ("r: -.inf\n", "site.yaml:1:4  r: -.inf is not a finite number."),
        ("r: 1.0e+999\n", "site.yaml:1:4  r: 1.0e+999 is not a finite number."),
        ("r: " + "9" * 5000 + "\n", "is not a finite number."),
        ("r: !!python/name:os.system x\n", "site.yaml:1:4  r: tag !!python/name:os.system"),
        ("r: !!set { a }\n", "site.yaml:1:4  r: tag !!set is not allowed."),
        ("? [a, b]\n: 1\n", "site.yaml:1:3  a key must be one word"),
        ("- 1\n- 2\n", "site.yaml:1:1  the file must be a mapping"),
        ("just text\n", "site.yaml:1:1  the file must be a mapping"),
        ("", "site.yaml:1:1  the file is empty."),
        ("# only a comment\n", "site.yaml:1:1  the file is empty."),
        ("a: [1, 2\nb: 3\n", "site.yaml:2:"),
        ("a: 'x\n", "site.yaml:2:1"),
        ("a: b: c\n", "site.yaml:1:5  mapping values are not allowed"),
        ("a: *nobody\n", "site.yaml:1:4  found undefined alias"),
        ("a: 1\n---\nb: 2\n", "site.yaml:2:1"),
        (b"a: 1\nb: \xff\n", "site.yaml:2:4  byte 0xff is not UTF-8."),
        ("[" * 100_000, "nests deeper than 20 levels"),
        ("a: &a [*a]\n", "aliases unfold to too much"),
        ("a: 1\x00\n", "site.yaml:"),
    ],
)
def test_trap_is_refused_where_it_stands(text, expected):
    lines = refused(text)
    assert expected in lines[0]
    assert all(line.startswith("site.yaml:") for line in lines)


def test_alias_bomb_is_bounded():
    levels = "".join(f"l{i}: &l{i} [{', '.join([f'*l{i - 1}'] * 9)}]\n" for i in range(1, 12))
    (line,) = refused("l0: &l0 [1]\n" + levels)
    assert "aliases unfold to too much" in line


def test_large_file_is_refused_before_it_is_parsed(tmp_path):
    path = tmp_path / "big.yaml"
    path.write_bytes(b"a" * (MAX_BYTES + 1))
    with pytest.raises(ConfigError, match=r"big\.yaml:1:1  is larger than 256 kB"):
        read_marked(path)


def test_missing_file_and_folder_are_refused(tmp_path):
    for path in (tmp_path / "none.yaml", tmp_path):
        with pytest.raises(ConfigError, match=":1:1  cannot be read: "):
            read_marked(path)


def test_several_findings_come_together_in_file_order():
    lines = refused("a: .nan\nb: 1\nb: 2\nc: 010\n")
    assert [line.split("  ")[0] for line in lines] == [
        "site.yaml:1:4",
        "site.yaml:3:1",
        "site.yaml:4:4",
    ]


def test_values_and_marks_are_kept_by_path():
    tree = parse_marked(b"a:\n  b: [1, 2.5, on, text]\n  c: 0x1F\n", "f")
    assert tree.values == {"a": {"b": (1, 2.5, True, "text"), "c": 31}}
    mark = tree.marks[("a", "b", 2)]
    assert (mark.line, mark.column, mark.written) == (2, 15, "on")
    assert (tree.marks[("a", "c")].key_line, tree.marks[("a", "c")].key_column) == (3, 3)


def test_byte_order_mark_does_not_shift_the_first_column():
    assert parse_marked(b"\xef\xbb\xbfa: 1\n", "f").marks[("a",)].key_column == 1


def test_dates_and_bare_exponents_stay_text():
    tree = parse_marked(b"a: 2026-11-21\nb: 1e-3\nc: 1.0e-3\n", "f")
    assert tree.values == {"a": "2026-11-21", "b": "1e-3", "c": 0.001}


def test_anchor_and_merge_give_values_that_own_keys_override():
    text = b"base: &b { x: 1, y: 2 }\nuse: { <<: *b, y: 3 }\nsame: *b\n"
    tree = parse_marked(text, "f")
    assert tree.values["use"] == {"y": 3, "x": 1}
    assert tree.values["same"] == {"x": 1, "y": 2}
    assert tree.marks[("use", "x")].line == 1


@given(st.binary(max_size=300))
def test_any_bytes_give_a_tree_or_a_config_error(raw):
    try:
        parse_marked(raw, "f")
    except ConfigError as error:
        assert_every_line_has_a_place(str(error))


@given(st.text(alphabet="ab:[]{},-&*!<>|?'\"# \n\t01.e_%@`", max_size=60))
def test_any_yaml_like_text_gives_a_tree_or_a_config_error(text):
    try:
        parse_marked(text.encode(), "f")
    except ConfigError as error:
        assert_every_line_has_a_place(str(error))


@each_case("escape", ["\\0", "\\e[2J", "\\x7f", "\\x85"])
def test_a_control_character_is_refused_where_it_stands(escape: str) -> None:
    with pytest.raises(ConfigError, match=r"t:2:7  name: holds a control character"):
        parse_marked(f'version: 1\nname: "a{escape}b"\n'.encode(), "t")
