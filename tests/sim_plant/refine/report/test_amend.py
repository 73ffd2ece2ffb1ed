"""The amended line file: its owner's, with what was found."""

import difflib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.declared.declaration import EffectEntry
from sim_plant.line.reading.load import load_line
from sim_plant.refine.model.hypotheses import hypothesis
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.amend import HEAD, write_amended
from sim_plant.refine.search.selection import Selection
from tests.sim_plant.refine.small import LINE_FILE, fit_of, verdict_with

ECCENTRIC = hypothesis(BY_NAME["eccentric_roller"], "R6")
FOUND = Selection(
    nominal=fit_of(),
    fit=fit_of(ECCENTRIC, values=((2e-4, 1e-5),)),
    record_axes=(),
    spectra_declared=(),
    spectra_left=(),
    adjustments={"web.EA_N": 1.2345678901234567e-05},
)
RECORD = Recording(
    path=Path("a.csv"), sha256="abc", sample_time_s=0.01, columns={"x_N": np.ones(9)}
)


def amended(line, folder, found=FOUND, stated=None):
    folder.mkdir(exist_ok=True)
    return write_amended(line, folder, found, [RECORD], "sim-plant refine", verdict_with(), stated)


@pytest.mark.parametrize(
    "name", ["euclid.yaml", pytest.param("euclid_ripple.yaml", marks=pytest.mark.long)]
)
def test_only_what_was_found_is_new_in_a_shipped_line_file(tmp_path, name):
    line = load_line(LINE_FILE.with_name(name))
    text = amended(line, tmp_path).read_text()
    assert text.startswith(HEAD + "# The Euclid")
    diff = list(difflib.ndiff(line.text.splitlines(), text.splitlines()))
    assert [row for row in diff if row.startswith("- ")] == []
    after = load_line(tmp_path / "line_amended.yaml").declaration
    same = {"effects", "corrections", "provenance"}
    assert after.model_dump(exclude=same) == line.declaration.model_dump(exclude=same)
    assert after.corrections["web.EA_N"] == 1.2345678901234567e-05  # to the last bit
    assert after.effects == (*line.declaration.effects, FOUND.fit.effects[0].entry())


def test_comments_of_the_owner_stay_where_they_are(tmp_path):
    own = tmp_path / "own.yaml"
    text = LINE_FILE.read_text()
    text = text.replace("  EA_N: 9300.0\n", "  EA_N: 9300.0  # pulled in the laboratory\n")
    text += "corrections:  # by hand\n  web.EA_N: 0.01  # May\n# the end\n"
    own.write_text(text)
    rows = amended(load_line(own), tmp_path / "out").read_text().splitlines()
    assert "  EA_N: 9300.0  # pulled in the laboratory" in rows
    assert "corrections:  # by hand" in rows
    (put_right,) = [row for row in rows if row.endswith("# May")]
    assert put_right.startswith("  web.EA_N: 0.0100123456")
    assert rows.index("# the end") == rows.index(put_right) + 1


def test_the_file_that_was_read_is_amended_whatever_became_of_it(tmp_path):
    own = tmp_path / "own.yaml"
    own.write_text(LINE_FILE.read_text())
    line = load_line(own)
    own.unlink()
    assert "amends: own.yaml" in amended(line, tmp_path / "out").read_text()


def test_an_amended_line_that_is_amended_again_says_so_once(tmp_path):
    first = amended(load_line(LINE_FILE), tmp_path / "first")
    again = amended(load_line(first), tmp_path / "again")
    assert again.read_text().count(HEAD) == 1
    found = load_line(again).declaration
    assert found.corrections["web.EA_N"] == pytest.approx(2 * 1.2345678901234567e-05)
    assert len(found.effects) == 2


def test_declared_effects_are_written_as_they_stood_when_the_record_began(tmp_path):
    line = load_line(LINE_FILE.with_name("euclid_ripple.yaml"))
    (declared, *rest) = line.declaration.effects
    name = next(n for n, v in declared.parameters.items() if isinstance(v, float))
    turned = EffectEntry(
        effect=declared.effect,
        location=declared.location,
        parameters={**declared.parameters, name: 0.0125},
    )
    path = amended(line, tmp_path, stated=(turned, *rest))
    assert load_line(path).declaration.effects[0] == turned


def test_the_line_file_itself_is_never_written(tmp_path):
    own = tmp_path / "line_amended.yaml"
    own.write_text(LINE_FILE.read_text())
    with pytest.raises(PlantError, match="is the line file itself"):
        amended(load_line(own), tmp_path)
    other = replace(load_line(own), path=LINE_FILE)
    assert amended(other, tmp_path / "out").name == "line_amended.yaml"
