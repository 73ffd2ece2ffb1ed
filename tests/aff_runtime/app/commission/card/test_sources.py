"""What a step of the card is gathered from: the site as it runs, not as it is written."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from aff_runtime.app.card import work
from aff_runtime.app.card.measure.search import values_of
from aff_runtime.app.commission import paths
from aff_runtime.app.commission.card import sources
from aff_runtime.app.commission.line import view as line_view
from aff_runtime.app.commission.link.messages import Request
from aff_runtime.app.commission.paths import Paths, parameters_of
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Site
from aff_runtime.core.identified import IdentifiedDrive
from tests.aff_runtime.app.judged_here import judged_here
from tests.aff_runtime.config.test_identified_drive import DRIVE, EUCLID, WEB
from tests.aff_runtime.core.test_identified import drive, response


def where(folder: Path, found: IdentifiedDrive | None) -> Paths:
    """Return the places of a site file without a whole drive, and of a probe beside it."""
    site = folder / "site.yaml"
    site.write_text(DRIVE.sub(WEB, EUCLID.read_text(encoding="utf-8"), count=1), encoding="utf-8")
    file = folder / load_site(site).actuators["unwind"].response
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(response(found).to_json(), encoding="utf-8")
    return Paths(site=site, state=folder, socket=folder / "none.sock", card=folder / "card")


def looked_at(places: Paths) -> Site:
    parameters = parameters_of(places.site, places.state)
    work.begin(places.card, places.site, parameters)
    return sources.sources(places, work.CardFile.of(places.card)).checked.site


@pytest.mark.parametrize(
    ("found", "tunes"), [(drive(), ["memory_turns"]), (None, ["settle_s", "settle_s"])]
)
def test_a_step_looks_at_the_drive_that_a_probe_identified(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    found: IdentifiedDrive | None,
    tunes: list[str],
) -> None:
    """With it law shape runs, and step 9 tunes its memory; without it the blocks that stand in."""
    monkeypatch.setattr(paths, "load_parameters", judged_here)
    site = looked_at(where(tmp_path, found))
    assert site.actuators["unwind"].uses_shape is (found is not None)
    assert [path[-1] for path in values_of(site, "unwind")] == tunes


def test_the_proof_of_the_page_is_as_long_as_the_law_that_runs_needs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Site] = []
    monkeypatch.setattr(line_view, "status_of", lambda socket: SimpleNamespace(live=None))
    monkeypatch.setattr(line_view, "proof_times", lambda site, standing: asked.append(site))
    line_view.line(where(tmp_path, drive()), Request(do="line"), None)  # type: ignore[arg-type]
    assert asked[0].actuators["unwind"].uses_shape
