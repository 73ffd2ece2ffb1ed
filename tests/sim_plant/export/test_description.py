"""What an importer shows of a line: names, units, bounds, what follows from what."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.cli.main import main
from sim_plant.export import binary, fmu
from sim_plant.export.c_text import c_string
from sim_plant.export.fmu import Export, export_line, settled_line
from sim_plant.export.units import UNITS
from sim_plant.export.variable import quoted
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.reading.load import load_declaration

LINES = Path(__file__).parents[3] / "config" / "lines"
LINE = load_declaration(LINES / "euclid.yaml")


@pytest.fixture(scope="module")
def third() -> Export:
    return export_line(settled_line(LINE), "euclid", "3.0")


@pytest.fixture(scope="module")
def tree(third: Export) -> ElementTree.Element:
    return ElementTree.fromstring(third.files["modelDescription.xml"])


def variables(tree: ElementTree.Element) -> list[ElementTree.Element]:
    found = tree.find("ModelVariables")
    assert found is not None
    return list(found)


def test_every_real_number_has_a_unit_that_is_defined_and_every_variable_a_sentence(
    tree: ElementTree.Element,
) -> None:
    defined = {unit.get("name") for unit in tree.iter("Unit")}
    for variable in variables(tree):
        assert variable.get("description"), variable.get("name")
        assert (variable.tag != "Float64") == (variable.get("unit") is None), variable.get("name")
        assert variable.get("unit") in (defined | {None})


def test_every_start_is_within_its_bounds(third: Export) -> None:
    for variable in third.interface.variables:
        if variable.start is not None:
            assert variable.low <= variable.start <= variable.high, variable.name


def test_outputs_stand_in_the_structure_and_none_follows_an_input_at_once(
    tree: ElementTree.Element,
) -> None:
    outputs = [v.get("valueReference") for v in variables(tree) if v.get("causality") == "output"]
    listed = list(tree.iter("Output"))
    assert [found.get("valueReference") for found in listed] == outputs
    assert {found.get("dependencies") for found in listed} == {""}
    assert [found.get("valueReference") for found in tree.iter("InitialUnknown")] == outputs


def test_the_description_is_the_same_in_both_versions(third: Export) -> None:
    second = export_line(settled_line(LINE), "euclid", "2.0")
    assert second.interface == third.interface
    scalars = ElementTree.fromstring(second.files["modelDescription.xml"]).iter("ScalarVariable")
    names = [scalar.get("name") for scalar in scalars]
    assert names == [variable.name for variable in third.interface.variables]


def test_every_recorded_channel_is_an_output_with_its_true_twin(third: Export) -> None:
    names = {variable.name for variable in third.interface.variables}
    for sensor in LINE.sensors:
        assert {sensor.channel, f"true_{sensor.channel}"} <= names
    for roller in LINE.rollers:
        assert f"rollers.{roller.name}.angle_rad" in names
    assert {"rollers.unwind.radius_now_m", "rollers.rewind.radius_now_m", "splice"} <= names


def test_units_have_the_exponents_of_what_they_are_named_after() -> None:
    newton = {"kg": 1, "m": 1, "s": -2}
    factors = {"N": newton, "1": {}} | {base: {base: 1} for base in ("m", "s", "rad", "kg", "K")}
    powers = {"kg.m2": {"kg": 1, "m": 2}, "kg/m3": {"kg": 1, "m": -3}, "Hz": {"s": -1}, "1": {}}
    for name, unit in UNITS.items():
        expected = dict(powers.get(name, {}))
        if name not in powers:
            over, _, under = name.partition("/")
            for part, sign in ((over, 1), (under.strip("()"), -1)):
                for factor in filter(None, part.split(".")):
                    for base, power in factors[factor].items():
                        expected[base] = expected.get(base, 0) + sign * power
        assert unit.exponents == {base: n for base, n in expected.items() if n}, name


def renamed(line: Declaration, name: str, other: str) -> Declaration:
    text = json.dumps(line.model_dump(mode="json", by_alias=True))
    return Declaration.model_validate(
        json.loads(text.replace(json.dumps(name), json.dumps(other)))
    )


@pytest.fixture(scope="module")
def odd() -> Export:
    """An export of a line with names that XML, C and FMI each take amiss."""
    other = renamed(LINE, "R9", 'R<9>"&%s')
    other = renamed(renamed(other, "pull_roll", "pull-roll"), "r3_tension_N", "R3 N")
    return export_line(settled_line(other), "1 line & more", "3.0")


def test_names_of_any_kind_reach_the_description_whole(odd: Export) -> None:
    assert quoted("S-wrap 1") == "'S-wrap 1'"
    assert quoted("it's") == r"'it\'s'"
    assert c_string('a"b%ä\\') == r'"a\042b\045\303\244\134"'
    assert odd.model.identifier == "line_1_line___more"
    tree = ElementTree.fromstring(odd.files["modelDescription.xml"])
    names = {variable.get("name") for variable in variables(tree)}
    assert {"rollers.'R<9>\"&%s'.angle_rad", "'aff_pull-roll_m_s'", "'true_R3 N'"} <= names


@pytest.mark.long  # compiles; quick: the names, above
def test_a_compiler_and_an_importer_take_names_of_any_kind(odd: Export, tmp_path: Path) -> None:
    fmu.write_fmu(odd, tmp_path / "odd.fmu")
    validation = pytest.importorskip("fmpy.validation", reason="FMPy, of the extra dev")
    assert validation.validate_fmu(str(tmp_path / "odd.fmu")) == []


def test_the_command_writes_the_file_and_says_what_is_in_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "line.fmu"
    given = ["export", str(LINES / "euclid.yaml"), "--fmu", "--out", str(out)]
    assert main([*given, "--fmi", "2.0", "--source-only", "--speed-m-s", "0.8"]) == 0
    assert "FMI 2.0" in (said := capsys.readouterr().out)
    assert "source and no binary:" in said
    with zipfile.ZipFile(out) as archive:
        assert not [name for name in archive.namelist() if name.startswith("binaries")]
        text = archive.read("modelDescription.xml")
    (speed,) = ElementTree.fromstring(text).findall(".//*[@name='line_speed_ref_m_s']/Real")
    assert (speed.get("unit"), speed.get("start")) == ("m/s", "0.8")
    monkeypatch.setattr(fmu, "compiler", lambda: None)
    assert main(given) == 0
    assert "no binary: there is no C compiler here" in capsys.readouterr().out


def test_the_command_refuses_what_no_importer_takes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = ["export", str(LINES / "euclid.yaml"), "--fmu"]
    assert main([*given, "--out", str(tmp_path / "a.zip")]) == 2
    assert "importers want a name that ends with .fmu" in capsys.readouterr().err
    assert main([*given, "--sample-time", "0.0015", "--out", str(tmp_path / "a.fmu")]) == 2
    assert "is not a multiple of" in capsys.readouterr().err


def test_a_source_that_does_not_compile_is_told_with_the_compilers_words(tmp_path: Path) -> None:
    program = binary.compiler()
    if program is None:
        pytest.skip("no C compiler on this machine")
    (tmp_path / "bad.c").write_text("int x = ;\n")
    with pytest.raises(PlantError, match=r"does not compile bad\.c: bad\.c:1"):
        binary.compile_binary(program, tmp_path, "bad.c", tmp_path / "out" / "bad.so")
