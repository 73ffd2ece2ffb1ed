"""Whatever is typed into a site file, the answer is a finite site or a refusal with a place."""

import math
from copy import deepcopy

import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from aff_runtime.base.errors import ConfigError
from aff_runtime.config.leaves import leaves
from aff_runtime.config.loader import load_site
from tests import quick_yaml
from tests.aff_runtime.config.shipped import EUCLID
from tests.drawn import drawn
from tests.drawn_text import drawn_text


def _keys(node, path=()):
    for name, inner in node.items():
        yield (*path, name)
        if isinstance(inner, dict):
            yield from _keys(inner, (*path, name))


@pytest.mark.parametrize(
    "path", list(_keys(quick_yaml.safe_load(EUCLID.read_text()))), ids=".".join
)
@pytest.mark.sweep(every=5)
def test_every_misspelt_key_of_the_shipped_file_is_refused(path, tmp_path):
    values = quick_yaml.safe_load(EUCLID.read_text(encoding="utf-8"))
    node = values
    for part in path[:-1]:
        node = node[part]
    wrong = path[-1][:-2] + path[-1][-1] + path[-1][-2]
    if wrong == path[-1]:
        wrong = path[-1][:-1]
    node[wrong] = node.pop(path[-1])
    file = tmp_path / "site.yaml"
    file.write_text(quick_yaml.safe_dump(values, sort_keys=False), encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        load_site(file)
    assert "Did you mean" in str(caught.value) or "does not end with its SI unit" in str(
        caught.value
    )


@pytest.mark.parametrize("index", range(3))
@pytest.mark.parametrize("name", ["roll", "orders", "settle_s", "amp_limit_m_s"])
def test_every_misspelt_block_key_is_refused_with_the_right_one(index, name, tmp_path):
    values = quick_yaml.safe_load(EUCLID.read_text(encoding="utf-8"))
    blocks = [block for part in values["actuators"].values() for block in part["blocks"]]
    blocks[index][name + "x"] = blocks[index].pop(name)
    file = tmp_path / "site.yaml"
    file.write_text(quick_yaml.safe_dump(values, sort_keys=False), encoding="utf-8")
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
_READ = quick_yaml.safe_load(_TEXT)
_BARE = "\n".join(line for line in _TEXT.split("\n") if not line.lstrip().startswith("#"))


@drawn(quick=15, long=100, without=list(HealthCheck))
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


@drawn(quick=15, long=100, without=list(HealthCheck))
@given(data=st.data())
def test_random_values_give_a_finite_site_or_a_config_error(data, tmp_path_factory):
    values = deepcopy(_READ)
    for _ in range(data.draw(st.integers(1, 2))):
        node = values
        while True:
            places = list(node) if isinstance(node, dict) else list(range(len(node)))
            if not places:
                break
            name = data.draw(st.sampled_from(places))
            inner = node[name]
            if not isinstance(inner, dict | list) or data.draw(st.integers(0, 4)) == 0:
                node[name] = deepcopy(data.draw(_VALUES))  # it may be changed in turn
                break
            node = inner
    path = tmp_path_factory.mktemp("fuzz") / "site.yaml"
    path.write_text(quick_yaml.safe_dump(values, sort_keys=False), encoding="utf-8")
    _assert_finite_or_refused(path)


_VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    drawn_text(max_size=8),
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
