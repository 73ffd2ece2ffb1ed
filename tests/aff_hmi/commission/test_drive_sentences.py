"""Why no drive was identified, and which one is in use, is told in the reader's language."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from aff_hmi.commission.in_language import line_in
from aff_hmi.commission.sentences import sentence
from aff_hmi.words import say_in
from aff_runtime.app.commission.line.view import line
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.paths import Paths
from aff_runtime.base.errors import RefusedError
from aff_runtime.config.identified_drive import with_identified
from aff_runtime.config.loader import load_site
from aff_runtime.core.identified import Estimate, IdentifiedDrive
from aff_runtime.core.identify.drive_fit import fit_drive
from aff_runtime.core.response import Response
from tests.aff_runtime.config.test_identified_drive import DRIVE, EUCLID
from tests.aff_runtime.core.identify.linear_line import LinearLine
from tests.aff_runtime.core.test_identified import drive, estimate, response

ENGLISH, GERMAN = say_in("en"), say_in("de")
TONES_Hz = 0.5 * np.arange(1, 13)


def faint(tones_Hz: npt.NDArray[np.float64] = TONES_Hz) -> str:
    """Return what a probe says whose tones drown in the noise, or are too few."""
    with pytest.raises(RefusedError) as refused:
        fit_drive(LinearLine().phasors(tones_Hz, 3.0), cycle_s=0.005, roll="unwind", radius_m=0.2)
    return str(refused.value)


def probed(found: IdentifiedDrive | None, why: str = "") -> Response:
    given = response(found)
    about = replace(given.provenance, measured_at="2026-11-23T10:00:00Z", config_hash="0123456789")
    return Response(points=given.points, delay_s=0.02, provenance=about, drive=found, no_drive=why)


UNSHOWN = Estimate(value=0.1, low=-0.1, high=0.3)
FOUND = {
    "declared": None,
    "none": probed(None),
    "why": probed(None, faint()),
    "few": probed(None, faint(TONES_Hz[:7])),
    "identified": probed(drive()),
    "not shown": probed(drive(integral_time_s=UNSHOWN)),
    "not sure": probed(drive(inertia_kg_m2=estimate(0.4, 0.5))),
}


@pytest.mark.parametrize("found", FOUND)
def test_what_is_said_of_a_drive_is_told_in_german_with_its_figures(
    found: str, tmp_path: Path
) -> None:
    path = tmp_path / "site.yaml"
    text = EUCLID.read_text()
    path.write_text(text if found == "declared" else DRIVE.sub("", text, count=1))
    said = str(with_identified(load_site(path), {"unwind": FOUND[found]})[1][0])
    assert sentence(said, ENGLISH) == said
    german = sentence(said, GERMAN)
    assert not re.search(r"\b(the|drive|probe|of|web|not)\b(?!\.)", german), german
    assert sorted(re.findall(r"\d+", german)) == sorted(re.findall(r"\d+", said))


def test_a_faint_probe_tells_how_many_tones_were_heard_and_are_needed() -> None:
    said = faint()
    heard, tones, least = map(
        int, re.findall(r"^(\d+) of (\d+) tones .*, (\d+) are needed", said)[0]
    )
    assert (tones, least) == (len(TONES_Hz), 10)
    assert heard < least
    assert "raise probe.amplitude_m_s" in said


@pytest.mark.parametrize("law", ["shape", "blocks"])
def test_the_page_says_why_where_a_law_waits_for_its_drive(law: str, tmp_path: Path) -> None:
    path = tmp_path / "site.yaml"
    text = DRIVE.sub("", EUCLID.read_text(), count=1)
    path.write_text(text.replace("law: shape", f"law: {law}", 1))
    (tmp_path / "learned").mkdir()
    (tmp_path / "learned" / "euclid_unwind.json").write_text(probed(None, faint()).to_json())
    where = Paths(site=path, state=tmp_path, socket=tmp_path / "no.sock", card=tmp_path)
    told = line_in(line(where, Request(do="line"), None).line, GERMAN)  # type: ignore[arg-type]
    said = next(one.no_drive for one in told.responses if one.actuator == "unwind")
    assert said.startswith("0 von 12 Tönen") == (law == "shape")
    assert ("unwind" in told.stands_in) == (law == "shape")
