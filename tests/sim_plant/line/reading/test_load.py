"""Every refusal of a line declaration says where, what was read and what to do."""

import copy

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.reading.load import load_declaration
from tests import quick_yaml
from tests.sim_plant.line.lines import LINES

TEXT = (LINES / "euclid.yaml").read_text()
DATA = quick_yaml.safe_load(TEXT)


def refusal(tmp_path, text):
    path = tmp_path / "line.yaml"
    path.write_text(text)
    with pytest.raises(PlantError) as caught:
        load_declaration(path)
    message = str(caught.value)
    assert str(path) in message
    return message.replace(str(path), "line.yaml")


def changed(change):
    data = copy.deepcopy(DATA)
    change(data)
    return quick_yaml.safe_dump(data, sort_keys=False)


def place_of(fragment):
    """line:column of the first key that starts with ``fragment``."""
    number, line = next((n, t) for n, t in enumerate(TEXT.split("\n"), 1) if fragment in t)
    return f"{number}:{line.index(fragment) + 1}"


@pytest.mark.parametrize("name", ["euclid", "euclid_ripple"])
def test_shipped_lines_load(name):
    assert len(load_declaration(LINES / f"{name}.yaml").rollers) == 21


@pytest.mark.parametrize(
    ("old", "new", "key", "said"),
    [
        ("  EA_N:", "  EA_lbf:", "web.EA_lbf", "Extra inputs are not permitted"),
        ("  thickness_m: ", "  thickness_m: -", "web.thickness_m", "greater than 0"),
        (
            "  drive_sample_time_s: 0.001",
            "  drive_sample_time_s: 1.0e-9",
            "control.drive_sample_time_s",
            "greater than or equal to 0.00001",
        ),
        ("  width_m: ", "  width_m: .nan #", "web.width_m", "read nan"),
        ("  width_m: ", "  width_m: .inf #", "web.width_m", "read inf"),
        ("  width_m: ", "  width_m: true #", "web.width_m", "valid number"),
        ("  width_m: ", "  width_m: 1e-1 #", "web.width_m", "write 0.1 without quotes"),
        ("  width_m: ", "  width_m: 6 in #", "web.width_m", "read '6 in'"),
        ("schema: ", "schema: v", "schema", "web-line-declaration/1"),
        ("sample_time_s: ", "sample_time_s: 0 #", "sample_time_s", "equal to 0.00001"),
    ],
)
def test_a_wrong_value_is_refused_at_its_line_and_column(tmp_path, old, new, key, said):
    assert old in TEXT
    message = refusal(tmp_path, TEXT.replace(old, new, 1))
    assert f"line.yaml:{place_of(old.strip())}: {key}: read " in message
    assert said in message


def test_a_missing_key_is_refused_at_its_section(tmp_path):
    text = changed(lambda d: d["web"].pop("EA_N"))
    number = text[: text.index("web:")].count("\n") + 1
    assert refusal(tmp_path, text).startswith(f"line.yaml:{number}:1: web.EA_N: Field required")


def test_every_wrong_key_is_named_at_once(tmp_path):
    text = TEXT.replace("  EA_N:", "  EA_lbf:", 1).replace("  width_m:", "  width_in:", 1)
    message = refusal(tmp_path, text)
    assert all(key in message for key in ("web.EA_lbf", "web.EA_N", "web.width_in"))


def test_a_repeated_key_is_refused_with_both_places(tmp_path):
    line = next(t for t in TEXT.split("\n") if t.startswith("  width_m:"))
    message = refusal(tmp_path, TEXT.replace(line, f"{line}\n{line}", 1))
    first = int(place_of("width_m:").split(":")[0])
    assert message == (
        f"line.yaml:{first + 1}:3: web.width_m: is given twice, first in line {first}; keep one"
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("- 1\n- 2\n", "holds no keys"),
        ("", "holds no keys"),
        ("a: [1, 2", "not YAML"),
        ("version: 1\ngateway: {}\n", "is a site file, which aff-runtime reads"),
        ("a: !!python/object:os.system {}", "not YAML"),
        ("note: 2020-13-45\n", "not YAML: a value cannot be read (month must be in 1..12)"),
        ("a: !!int foo\n", "not YAML: a value cannot be read"),
        ("a: &x [*x]\n", "line.yaml:1:4: its aliases unfold to too much"),
        ("a: " + "[" * 3000 + "]" * 3000, "line.yaml:1:35: is nested deeper than 32 levels"),
    ],
)
def test_what_is_no_declaration_is_refused(tmp_path, text, said):
    assert said in refusal(tmp_path, text)


def test_an_unreadable_file_is_refused_with_where_shipped_ones_lie(tmp_path):
    with pytest.raises(PlantError, match=r"nowhere\.yaml: cannot be read ") as told:
        load_declaration(tmp_path / "nowhere.yaml")
    assert load_declaration(f"{told.value}/euclid.yaml".rpartition(" lie in ")[2])
    (tmp_path / "binary.yaml").write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(PlantError, match="cannot be read"):
        load_declaration(tmp_path / "binary.yaml")


def _set(path, value):
    def change(data):
        *way, last = path
        for key in way:
            data = data[key]
        data[last] = value

    return change


CONTRADICTIONS = {
    "spans: must join the rollers in web order": _set(["spans", 3, "end"], "R9"),
    "rollers: R3 appears twice": _set(["rollers", 4, "name"], "R3"),
    "rollers: the first and the last must be of kind roll": _set(["rollers", 0, "kind"], "driven"),
    "rollers.R5.kind: read 'roll'; only the first and the last can be": _set(
        ["rollers", 5, "kind"], "roll"
    ),
    "spans.R1-R2.length_m: read 0.7, but the centres and radii give 0.6": _set(
        ["spans", 1, "length_m"], 0.7
    ),
    "spans.R1-R2: the two bodies overlap": _set(["rollers", 2, "radius_m"], 0.9),
    "control.drives: roller R99 does not exist": _set(["control", "drives", 1, "roller"], "R99"),
    "control.drives: unwind appears twice": _set(["control", "drives", 1, "roller"], "unwind"),
    "control.tension_pi: roller R99 does not exist": _set(
        ["control", "tension_pi", 0, "acts_on"], "R99"
    ),
    "control.tension_pi.unwind: no load cell on R4": _set(
        ["control", "tension_pi", 0, "load_cell"], "R4"
    ),
    "control.tension_pi.unwind: no drive on R4": _set(
        ["control", "tension_pi", 0, "acts_on"], "R4"
    ),
    "sensors.r3_tension_N: roller R99 does not exist": _set(["sensors", 2, "roller"], "R99"),
    "sensors: unwind_tension_N appears twice": _set(["sensors", 1, "channel"], "unwind_tension_N"),
    "sensors: a load cell needs a span on both sides, rewind has one": _set(
        ["sensors", 3, "roller"], "rewind"
    ),
    "control: tension loop period must be a multiple of the drive period": _set(
        ["control", "tension_loop_sample_time_s"], 0.0105
    ),
}


@pytest.mark.parametrize("said", CONTRADICTIONS)
def test_a_declaration_that_contradicts_itself_is_refused(tmp_path, said):
    assert f"line.yaml: {said}" in refusal(tmp_path, changed(CONTRADICTIONS[said]))


def test_records_of_other_lines_lose_nothing_on_the_way(line_records):
    """Every key and value of these declarations comes back from a Declaration unchanged."""
    paths = sorted(line_records.glob("line*.yaml"))
    assert len(paths) == 16
    for path in paths:
        data = quick_yaml.safe_load(path.read_text())
        line = load_declaration(path)
        assert line.model_dump(mode="json", by_alias=True, exclude_unset=True) == data


@pytest.mark.parametrize("name", ["euclid", "euclid_ripple"])
def test_shipped_declarations_lose_nothing_and_give_every_origin(name):
    data = quick_yaml.safe_load((LINES / f"{name}.yaml").read_text())
    line = load_declaration(LINES / f"{name}.yaml")
    assert line.model_dump(mode="json", by_alias=True, exclude_unset=True) == data
    assert Declaration.model_validate(line.model_dump(by_alias=True)) == line


def test_a_sensor_takes_the_keys_of_its_kind_and_no_others(tmp_path):
    text = TEXT.replace("  noise_sd_N: 0.25\n", "  noise_sd_rad_s: 0.25\n", 1)
    path = tmp_path / "line.yaml"
    path.write_text(text)
    with pytest.raises(PlantError, match=r"sensors\.0\.noise_sd_rad_s: .*[Ee]xtra") as refused:
        load_declaration(path)
    line = text[: text.index("noise_sd_rad_s: 0.25")].count("\n") + 1
    assert f"line.yaml:{line}:" in str(refused.value)


def test_a_sensor_that_names_its_kind_means_the_same(tmp_path):
    path = tmp_path / "line.yaml"
    path.write_text(
        TEXT.replace("- channel: r3_tension_N", "- kind: load_cell\n  channel: r3_tension_N")
    )
    assert load_declaration(path).sensors == Declaration.model_validate(DATA).sensors
