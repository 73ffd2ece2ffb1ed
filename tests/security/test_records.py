"""A record is data: nothing in it is run, and nothing of it acts on a terminal or in a page."""

from __future__ import annotations

import io
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import asammdf
import numpy as np
import pytest
from asammdf.blocks import v4_blocks

from aff_runtime.base.errors import PlantError
from sim_plant.refine.records import mdf_table as reader
from sim_plant.refine.records.mdf_formulas import FORMULA_KINDS, nothing_evaluated, refuse_formulas
from sim_plant.refine.records.mdf_table import mdf_table
from sim_plant.refine.records.read import read_record
from tests.security.record_files import (
    STAMPS,
    TIME,
    VALUES,
    algebraic,
    formula_3,
    logged_bus,
    put,
    range_to,
    rational,
    saved,
    touching,
)

pytestmark = pytest.mark.processes

EVALUATING = r"(?<![\w.])(evaluate|lambdify|eval|exec)\("
PLACES = {
    "value": ("4.10", lambda text: put(algebraic(text))),
    "time": ("4.10", lambda text: put(algebraic(text), TIME)),
    "in a table": ("4.10", lambda text: put(range_to(algebraic(text)))),
    "in a table's default": ("4.10", lambda text: put(range_to(b"low", algebraic(text)))),
    "two tables deep": ("4.10", lambda text: put(range_to(range_to(b"", algebraic(text))))),
    "bus": ("4.10", lambda text: logged_bus(algebraic(text))),
    "value of MDF 3": ("3.30", lambda text: put(formula_3(text))),
    "time of MDF 3": ("3.30", lambda text: put(formula_3(text), TIME)),
}


@pytest.fixture
def mark(tmp_path, monkeypatch):
    """Return a file that an evaluated formula makes: numexpr's own filter is off."""
    monkeypatch.setenv("NUMEXPR_SANITIZE", "0")
    return tmp_path / "was run"


def test_asammdf_by_itself_runs_the_formula_of_this_test(tmp_path, mark):
    """Else the tests below would prove nothing; bus frames are read while a file is opened."""
    path = saved(tmp_path / "r.mf4", "4.10", logged_bus(algebraic(touching(mark))))
    asammdf.MDF(io.BytesIO(path.read_bytes())).close()
    assert mark.exists()


@pytest.mark.parametrize("place", PLACES)
def test_a_formula_is_refused_and_never_run(tmp_path, mark, place):
    version, change = PLACES[place]
    ending = "mf4" if version[0] == "4" else "mdf"
    path = saved(tmp_path / f"r.{ending}", version, change(touching(mark)))
    with pytest.raises(PlantError) as raised:  # as the child of a reading does it
        mdf_table(path, path.read_bytes())
    said = str(raised.value)
    assert not mark.exists()
    assert said.startswith(f"{path}: channel ")
    assert "its conversion is the formula 'X1 + (lambda: __import__(" in said
    assert said.endswith("export the record with raw or with physical values")


@pytest.mark.parametrize("place", ["time", "bus"])
@pytest.mark.sweep(every=2)
def test_a_reading_refuses_a_formula_in_the_words_of_its_child(tmp_path, mark, place):
    version, change = PLACES[place]
    path = saved(tmp_path / "r.mf4", version, change(touching(mark)))
    with pytest.raises(PlantError, match="its conversion is the formula"):
        read_record(path)
    assert not mark.exists()


def test_a_formula_is_shown_escaped_and_cut(tmp_path):
    text = "X + 1 \x1b[2J\nINFO OPERATOR: arm \u202e" + "+ 1" * 5000
    path = saved(tmp_path / "r.mf4", "4.10", put(algebraic(text)))
    with pytest.raises(PlantError, match=r"\\x1b\[2J\\nINFO OPERATOR: arm \\u202e") as raised:
        mdf_table(path, path.read_bytes())
    assert str(raised.value).isprintable()
    assert len(str(raised.value)) < 500


def test_the_axis_of_an_array_is_looked_at(tmp_path):
    """Arrays are refused anyway, by what they hold, but after they were read."""
    block = SimpleNamespace(dims=1, axis_conversion_0=algebraic("X"))
    group = SimpleNamespace(channels=[], channel_dependencies=[None, [block]])
    with pytest.raises(PlantError, match="axis of an array: its conversion is the formula 'X'"):
        refuse_formulas(tmp_path, SimpleNamespace(groups=[group]))


@pytest.mark.parametrize("place", ["value", "time", "two tables deep", "value of MDF 3"])
def test_a_conversion_that_is_overlooked_is_not_run_either(tmp_path, mark, monkeypatch, place):
    version, change = PLACES[place]
    monkeypatch.setattr(reader, "refuse_formulas", lambda *_: None)
    path = saved(tmp_path / "r.mf4", version, change(touching(mark)))
    with pytest.raises(PlantError, match="its conversion is the formula"):
        mdf_table(path, path.read_bytes())
    assert not mark.exists()


def test_every_place_of_asammdf_that_evaluates_text_is_one_that_is_kept_from_it():
    root = Path(asammdf.__file__).parent
    found = set()
    for path in root.rglob("*.py"):
        if "gui" not in path.parts:
            calls = re.findall(
                r"(?<![\w.])(evaluate|lambdify|eval|exec)\(", path.read_text("utf-8")
            )
            module = ".".join(("asammdf", *path.relative_to(root).with_suffix("").parts))
            found |= {(module, name) for name in calls}
    assert found == {(module, n) for module in FORMULA_KINDS for n in ("evaluate", "lambdify")}
    assert {FORMULA_KINDS["asammdf.blocks.v4_blocks"]} == {algebraic("X").conversion_type}
    assert {FORMULA_KINDS["asammdf.blocks.v2_v3_blocks"]} == {formula_3("X").conversion_type}


def test_an_asammdf_that_evaluates_by_another_name_reads_nothing(tmp_path, monkeypatch):
    monkeypatch.delattr(v4_blocks, "evaluate")
    with pytest.raises(PlantError, match="may evaluate formulas"), nothing_evaluated(tmp_path):
        pytest.fail("went on")
    monkeypatch.undo()
    kept = v4_blocks.evaluate
    with nothing_evaluated(tmp_path):
        assert v4_blocks.evaluate is not kept
    assert v4_blocks.evaluate is kept


def test_conversions_by_numbers_are_still_done(tmp_path):
    """Rational: asammdf hands a text of its own to the same evaluator."""
    numbers = {"P1": 1.0, "P2": 2.0, "P3": 3.0, "P4": 0.5, "P5": 0.25, "P6": 4.0}
    path = saved(tmp_path / "r.mf4", "4.10", put(rational(**numbers)))
    x = VALUES
    expected = (x**2 + 2.0 * x + 3.0) / (0.5 * x**2 + 0.25 * x + 4.0)
    found = mdf_table(path, path.read_bytes())[0]["unwind_tension_N"]
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_the_libraries_run_in_a_child_that_takes_no_module_from_the_folder(tmp_path):
    """A folder with a module of asammdf's name beside the record: it stays unread."""
    (tmp_path / "asammdf.py").write_text(f"open({str(tmp_path / 'was run')!r}, 'w')")
    saved(tmp_path / "r.mf4", "4.10")
    program = (
        "import sys; from sim_plant.refine.records.read import read_record\n"
        "assert read_record('r.mf4').samples == 400\n"
        "assert not {'asammdf', 'numexpr', 'pyarrow', 'pandas'} & set(sys.modules)"
    )
    subprocess.run(
        [sys.executable, "-P", "-c", program], cwd=tmp_path, check=True, timeout=60, env=None
    )
    assert not (tmp_path / "was run").exists()


NAMES = ("unwind\x1b[2J_N", "unwind\u202e_N", "unwind\u2028_N", "a\x07_N", "\u200b_N")


@pytest.mark.parametrize("name", NAMES)
def test_a_column_name_that_does_not_print_comes_out_escaped(tmp_path, name):
    path = tmp_path / "r.csv"
    rows = "\n".join(f"{t:.2f},1.0" for t in STAMPS)
    path.write_text(f"time_s,{name}\n{rows}\n", encoding="utf-8")
    record = read_record(path)
    (found,) = record.columns
    assert found.isprintable()
    assert all(text.isprintable() for text in record.findings)


@pytest.mark.parametrize(
    ("head", "cell"),
    [
        ("time_s,\x1b[2Jx_N", "open"),
        ("time_s,x_N", "\x1b[2J"),
        ("time_s,x_N,x_N", "1.0"),
        ("\x1b[31mwhen,x_N", "1.0"),
        ("time_s,x\x1b [furlong]", "1.0"),
        ("time_s,\x1bx [N],\x1bx [kN]", "1.0,1.0"),
        ("time_s,x\x1b_N", "1e300"),
        ("time_s,x\x1b_N", ""),
    ],
)
def test_what_is_said_of_a_record_prints(tmp_path, head, cell):
    path = tmp_path / "r\x1b.csv"
    rows = "\n".join(f"{t:.2f},{cell}" for t in STAMPS)
    path.write_text(f"{head}\n{rows}\n", encoding="utf-8")
    with pytest.raises(PlantError) as raised:
        read_record(path)
    assert str(raised.value).isprintable()
