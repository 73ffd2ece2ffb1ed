from aff_runtime.base.yaml_section import Section
from tests.each_case import each_case

GIVEN = Section.of({"line": {"name": "euclid"}, "rolls": {"unwind": {"angle": "a"}, "odd": 3}})


def test_a_section_within_is_read_by_name() -> None:
    assert GIVEN.section("line").get("name") == "euclid"
    assert [roll.get("angle") for roll in GIVEN.section("rolls").sections()] == ["a"]
    assert dict(GIVEN.section("rolls").items())["odd"] == 3


@each_case("given", [None, 3, "text", ["a"], {}])
def test_what_is_no_section_is_an_empty_one(given: object) -> None:
    found = Section.of(given)
    assert not found
    assert found.get("name") is None
    assert not found.section("line")
    assert list(found.sections()) == []
