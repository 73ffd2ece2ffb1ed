"""A small file does not cost much: no cell, stamp or number makes memory, time or a traceback."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.base import yaml_edit
from sim_plant.line.reading.load import load_declaration
from sim_plant.line.record_file import LONGEST_LINE, read_columns
from sim_plant.refine.records.sanity import even_grid
from sim_plant.refine.records.text_table import text_table
from sim_plant.refine.without_line.record_filter import RecordDeclaration, read_stamped
from tests import quick_yaml
from tests.aff_runtime.config.shipped import ROOT

pytestmark = pytest.mark.processes

CSV = Path("r.csv")


@pytest.mark.parametrize("at", [2, 3])
def test_an_open_quote_does_not_take_in_the_lines_that_follow(at):
    """Every line is a cell of one row otherwise, each held as a text of some 60 bytes."""
    fine = b"0.01,1.0\n" * (at - 2)
    with pytest.raises(PlantError, match=rf"^r.csv: line {at}: a quote is left open; close it"):
        text_table(CSV, b"time_s,x_N\n" + fine + b'"123\n",' * 10_000)


def test_cells_in_quotes_are_read():
    table = text_table(CSV, b'"time_s","x_N"\n"0.01","1.5"\n0.02,"2.5"\n')
    assert {name: values.tolist() for name, values in table.items()} == {
        "time_s": [0.01, 0.02],
        "x_N": [1.5, 2.5],
    }


def test_a_line_without_end_is_not_handed_to_numpy(tmp_path):
    """It took 22 bytes for each character of the line."""
    file = tmp_path / "r.csv"
    file.write_text("time_s,x_N\n0,1\n" + "1," * (LONGEST_LINE // 2 + 1), encoding="ascii")
    with pytest.raises(PlantError, match=rf"line 3 is longer than {LONGEST_LINE} characters"):
        read_columns(file)


def calls_of(act):
    """Return how many functions ``act`` calls, those of libraries in C too."""
    count = 0

    def one(_frame, event, _what):
        nonlocal count
        count += event in ("call", "c_call")

    sys.setprofile(one)
    try:
        act()
    finally:
        sys.setprofile(None)
    return count


def stamps(rows):
    """Return 0 1 2 2 4 5 6 6 8 ...: of every four stamps one sits on its neighbour's."""
    found = np.arange(rows, dtype=np.float64)
    found[3::4] -= 1.0
    return found


def test_misplaced_stamps_are_counted_and_put_on_the_grid():
    """Every fourth of 1001 stamps is misplaced, and the two steps beside it are odd: 0 and 2."""
    step, columns, said = even_grid(CSV, stamps(1001), {"x_N": np.ones(1001)})
    assert step == 1.0
    assert columns["x_N"].tolist() == [1.0] * 1001
    assert said[0] == "250 misplaced stamps"


def test_a_gap_among_misplaced_stamps_is_found_at_its_place():
    late = stamps(1001)
    late[601:] += 7.0
    with pytest.raises(
        PlantError, match=r"1 gaps in time_s, the first after line 602 \(8 s where"
    ):
        even_grid(CSV, late, {"x_N": np.ones(1001)})


def test_the_effort_for_odd_stamps_does_not_grow_with_their_number():
    """One look for each of them, among all others, was days for a record of 10 MB."""
    few, many = (
        calls_of(lambda n=rows: even_grid(CSV, stamps(n), {"x_N": np.ones(n)}))
        for rows in (401, 4001)
    )
    assert many == few


@pytest.mark.parametrize(
    ("section", "key", "value", "said"),
    [
        ("rollers", "center_x_m", 1e300, "the centres and radii give inf"),
        ("control", "tension_loop_sample_time_s", 1e300, "must be a multiple of the drive period"),
    ],
)
def test_a_number_that_overflows_is_refused_in_words(tmp_path, section, key, value, said):
    line = quick_yaml.safe_load((ROOT / "config/lines/euclid.yaml").read_text(encoding="utf-8"))
    part = line[section]
    (part[0] if isinstance(part, list) else part)[key] = value
    file = tmp_path / "line.yaml"
    file.write_text(quick_yaml.safe_dump(line), encoding="utf-8")
    with pytest.raises(PlantError, match=said):
        load_declaration(file)


def test_lines_that_are_alike_are_not_compared_each_with_each(monkeypatch):
    """10 000 empty comments below a line file took 50 s when its amended copy was written."""
    monkeypatch.setattr(yaml_edit.difflib, "SequenceMatcher", None)  # the one that takes so long
    found = yaml_edit.with_keys("a: 1\nb: 2  # ours\n" + "#\n" * 10_000, {"b": 3})
    assert quick_yaml.safe_load(found) == {"a": 1, "b": 3}


def test_a_file_of_usual_length_keeps_its_comments():
    text = (ROOT / "config/lines/euclid.yaml").read_text(encoding="utf-8") + "#\n" * 300
    assert yaml_edit.with_keys(text, {"note": "x"}).endswith("#\n" * 300)


def test_a_filter_that_would_fill_the_memory_is_refused_before_it_is_laid_out(tmp_path):
    """One column under many names of it, a thousand times shifted: 9 GB of a file of 60 kB."""
    file = tmp_path / "r.csv"
    rows = "".join(f"{0.01 * k:.2f},{k % 7},{k % 5}\n" for k in range(6000))
    file.write_text("time_s,x,y\n" + rows)
    declared = {"schema": "record-declaration/1", "sample_time_s": 0.01, "outputs": ["y"]}
    many = RecordDeclaration.model_validate({**declared, "inputs": ["x"] * 200, "taps": 500})
    with pytest.raises(PlantError, match=r"6000 rows under a filter of 200201 weights"):
        read_stamped(many, file)
    one = RecordDeclaration.model_validate({**declared, "inputs": ["x"], "taps": 500})
    assert read_stamped(one, file).record.samples == 6000
