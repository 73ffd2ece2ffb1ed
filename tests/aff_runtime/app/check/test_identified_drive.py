"""The check fills in a drive that a probe identified; what it says and what it refuses."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from aff_runtime.app.check.validate import check_result
from aff_runtime.config.check import check_site
from aff_runtime.core.identified import IdentifiedDrive
from aff_runtime.core.response import Provenance, Response
from tests.aff_runtime.config.test_identified_drive import DRIVE, EUCLID
from tests.aff_runtime.core.test_identified import drive, response


def site_with(folder: Path, found: IdentifiedDrive | None) -> Path:
    """Return Euclid's file without a drive, beside a response that holds ``found``."""
    path = folder / "site.yaml"
    path.write_text(DRIVE.sub("", EUCLID.read_text(), count=1))
    learned = folder / "learned" / "euclid_unwind.json"
    learned.parent.mkdir()
    kept = response(found)
    about = Provenance(
        actuator="unwind",
        signal="unwind_tension_N",
        cycle_s=0.005,
        measured_at="2026-11-23T10:00:00Z",
        config_hash="0123456789abcdef",
    )
    points = [replace(kept.points[0], frequency_Hz=f) for f in (0.5, 1.0, 2.0, 4.0)]
    told = Response(points=points, delay_s=kept.delay_s, provenance=about, drive=found)
    learned.write_text(told.to_json())
    return path


def test_the_record_has_the_whole_drive_and_says_where_it_is_from(tmp_path):
    parameters = check_result(site_with(tmp_path, drive()), tmp_path).checked()
    assert parameters.site.actuators["unwind"].uses_shape
    assert "unwind" in parameters.loops
    assert parameters.shape_files.keys() == {"unwind"}
    (said,) = parameters.drives
    assert said.startswith("unwind: drive identified 2026-11-23T10:00:00Z at 0.200 m")
    assert "site file 01234567" in said


def test_the_site_files_own_hash_is_that_of_the_file(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    with_drive = check_result(site_with(tmp_path / "a", drive()), tmp_path).checked()
    without = check_result(site_with(tmp_path / "b", None), tmp_path).checked()
    assert with_drive.site_hash == without.site_hash
    assert with_drive.config_hash != without.config_hash


def test_without_an_identified_drive_the_plain_blocks_stand_in_as_before(tmp_path):
    parameters = check_result(site_with(tmp_path, None), tmp_path).checked()
    assert parameters.site.actuators["unwind"].law_that_runs == "blocks"
    assert parameters.drives[0].startswith("unwind: plain blocks stand in: ")


@pytest.mark.parametrize("found", [drive(), None], ids=["identified", "none"])
def test_the_command_check_says_the_same(tmp_path, found):
    site = site_with(tmp_path, found)
    said = [line for line in check_site(site, (), tmp_path).lines() if line.startswith("drive  ")]
    assert said == [f"drive  {text}" for text in check_result(site, tmp_path).checked().drives]
