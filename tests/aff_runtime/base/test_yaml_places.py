"""The reader that site files and line files share: bounds, places and kinds of faults."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from aff_runtime.base.errors import AffError
from aff_runtime.base.yaml_places import Bounds, Fault, YamlTextError, compose, line_and_column
from aff_runtime.config import yaml_marks
from aff_runtime.config.yaml_marks import parse_marked
from sim_plant.line import yaml_file
from sim_plant.line.yaml_file import parse_yaml
from tests.each_case import each_case

BOUNDS = Bounds(depth=2, events=12, characters=5)


def test_every_node_has_the_place_where_it_begins() -> None:
    root = compose("a: 1\nb:\n  - x\n", BOUNDS)
    assert isinstance(root, yaml.MappingNode)
    (_, one), (key, items) = root.value
    assert [line_and_column(node) for node in (root, one, key, items)] == [
        (1, 1),
        (1, 4),
        (2, 1),
        (3, 3),
    ]


def test_a_text_without_a_value_has_no_root() -> None:
    assert compose("# nothing\n", BOUNDS) is None


@each_case(
    ("text", "fault", "place"),
    [
        ("a: [1\n", Fault.SYNTAX, (2, 1)),
        ("a: 1\nb: \x01\n", Fault.CHARACTERS, (2, 4)),
        ("a: [[1]]\n", Fault.DEPTH, (1, 5)),
        ("[1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2]\n", Fault.COUNT, (1, 32)),
        ("a: 123456\n", Fault.LENGTH, (1, 4)),
    ],
)
def test_a_fault_is_told_by_its_kind_and_place(
    text: str, fault: Fault, place: tuple[int, int]
) -> None:
    with pytest.raises(YamlTextError) as caught:
        compose(text, BOUNDS)
    assert (caught.value.fault, caught.value.place) == (fault, place)


@each_case(
    "read", [lambda text: parse_marked(text.encode(), "f"), lambda text: parse_yaml(text, "f")]
)
@each_case(
    ("text", "place"), [("a: [1\n", "f:2:1"), ("a: 1\nb: \x01\n", "f:2:4"), ("a: b: c\n", "f:1:5")]
)
def test_site_files_and_line_files_name_the_same_place(
    read: Callable[[str], object], text: str, place: str
) -> None:
    with pytest.raises(AffError) as caught:
        read(text)
    assert str(caught.value).startswith(place)


@pytest.mark.parametrize("module", [yaml_marks, yaml_file])
def test_nobody_else_parses_text(module: object) -> None:
    source = Path(str(getattr(module, "__file__", ""))).read_text(encoding="utf-8")
    assert not any(call in source for call in ("yaml.parse", "yaml.compose", "yaml.load"))
