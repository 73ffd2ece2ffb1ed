"""The generated pages are fresh, and every key of the site file is declared in full."""

import json

import annotated_types

from aff_runtime.config import quantity
from aff_runtime.config.declared import keys_of, walk
from aff_runtime.config.models import Site
from aff_runtime.config.reference import PAGE, SCHEMA, json_schema, reference_page
from tests.aff_runtime.config.shipped import ROOT
from tests.each_case import each_case

KEYS = dict(walk(Site))
SHIPPED = ROOT / "config" / "euclid.yaml"
AGAIN = "run: python -m aff_runtime.config.reference"


def _sections(section=quantity.Section):
    for inner in section.__subclasses__():
        yield inner
        yield from _sections(inner)


def test_reference_page_is_fresh():
    assert (ROOT / PAGE).read_text(encoding="utf-8") == reference_page(), AGAIN


def test_what_counts_in_si_per_count_is_a_scale_and_a_ratio_is_none():
    rows = [row.split("|") for row in reference_page().splitlines() if "| SI per count |" in row]
    assert {row[1].strip() for row in rows} == {"`scale`"}


def test_json_schema_is_fresh():
    assert (ROOT / SCHEMA).read_text(encoding="utf-8") == json_schema(), AGAIN


def test_walk_reaches_every_section():
    reached = {declared.section for declared in KEYS.values()} | {
        declared.item.section for declared in KEYS.values() if declared.item is not None
    }
    assert set(_sections()) - {Site} == reached - {None}


@each_case("path", KEYS)
def test_key_has_a_sentence(path):
    description = KEYS[path].description
    assert len(description) >= 20
    assert description[-1] in ".)"


@each_case("path", KEYS)
def test_number_has_a_unit_and_two_bounds(path):
    declared = KEYS[path]
    while declared.item is not None and declared.item.section is None:
        declared = declared.item
    if declared.leaf not in (int, float):
        return
    assert declared.unit is not None
    kinds = {type(mark) for mark in declared.metadata}
    assert kinds & {annotated_types.Ge, annotated_types.Gt}, "no lower bound"
    assert kinds & {annotated_types.Le, annotated_types.Lt}, "no upper bound"


@each_case("path", KEYS)
def test_float_key_spells_its_unit(path):
    declared = KEYS[path]
    if declared.leaf is not float or declared.unit == "":
        return
    suffix = declared.unit.replace("/", "_").replace(" ", "_")
    assert path.endswith(f"_{suffix}")


@each_case("section", list(_sections()), ids=lambda section: section.__name__)
def test_section_refuses_a_misspelt_key_and_never_changes(section):
    assert section.model_config["extra"] == "forbid"
    assert section.model_config["frozen"] is True
    assert section.__doc__
    assert keys_of(section)


def test_schema_bounds_and_shows_units():
    block = json.loads(json_schema())["$defs"]["Block"]
    settle = block["properties"]["settle_s"]
    assert (settle["minimum"], settle["maximum"], settle["x-unit"]) == (1, 300, "s")
    assert settle["x-live"] is True
    assert block["additionalProperties"] is False


ON_CAN = {
    path
    for path in KEYS
    if path.startswith("gateway.can") or path.endswith(("signal", "complement_signal"))
}


def test_shipped_file_shows_every_optional_key_of_its_sections():
    text = SHIPPED.read_text(encoding="utf-8")
    on_can = "".join(
        SHIPPED.with_name(f"euclid_{wire}.yaml").read_text(encoding="utf-8")
        for wire in ("can", "canopen")
    )
    not_for_this_line = {"speed", "line_speed", "min_m", "max_m", "min_rad_s", "max_rad_s"}
    not_for_this_line |= {"min_N_m", "max_N_m", "limit_N_m", "slew_N_m_s", "amp_limit_N_m"}
    not_for_this_line |= {"noise_m_s"}
    for path, declared in KEYS.items():
        name = path.rsplit(".", 1)[-1]
        if declared.section is None and name not in not_for_this_line:
            assert f"{name}:" in (on_can if path in ON_CAN else text), path


def test_schema_accepts_the_keys_of_the_shipped_file():
    schema = json.loads(json_schema())
    assert set(schema["required"]) == {
        "version",
        "line",
        "gateway",
        "permissives",
        "plausibility",
        "rolls",
        "actuators",
    }
    assert schema["$defs"]["Channel"]["properties"].keys() >= {"register", "type", "scale"}
