"""The check in its own process, and the record it hands over."""

from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.app.assemble import controller_of, revision_of, site_of
from aff_runtime.app.validation import load_record
from aff_runtime.base.errors import ConfigError
from aff_runtime.config.loader import load_site
from aff_runtime.config.revision import revision_word

SITE = Path(__file__).parents[3] / "config" / "euclid.yaml"


def test_the_record_of_a_good_file_carries_the_whole_site() -> None:
    verdict = load_record(SITE)
    record = verdict.record
    assert record is not None
    assert site_of(record) == load_site(SITE)
    assert record["site_text"] == SITE.read_text()
    assert revision_of(record) == revision_word(load_site(SITE))
    assert controller_of(site_of(record), record["responses"]).arming_objections()


@pytest.mark.parametrize(
    ("before", "after"),
    [("version: 1", "version: 7"), ("cycle_ms: 5", "cycle: 5"), ("cycle_ms: 5", "cycle_ms: 5e0")],
)
def test_a_bad_file_comes_back_with_its_place_and_without_a_record(
    tmp_path: Path, before: str, after: str
) -> None:
    path = tmp_path / "site.yaml"
    path.write_text(SITE.read_text().replace(before, after, 1))
    line = 1 + next(i for i, t in enumerate(path.read_text().splitlines()) if after in t)
    with pytest.raises(ConfigError, match=f"site.yaml:{line}:"):
        load_record(path)


def test_a_response_file_that_is_none_is_a_finding_at_its_key(tmp_path: Path) -> None:
    path = tmp_path / "site.yaml"
    path.write_text(SITE.read_text())
    (tmp_path / "learned").mkdir()
    (tmp_path / "learned" / "euclid_unwind.json").write_text('{"format": "x"}')
    with pytest.raises(ConfigError, match=r"site\.yaml:\d+:\d+  actuators\.unwind\.response"):
        load_record(path)
