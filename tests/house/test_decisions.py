"""Decisions are numbered without holes, have their parts, and stand in the index."""

import re

from tests.each_case import each_case
from tests.house.documents import ROOT, text

FOLDER = ROOT / "docs" / "adr"
PAGES = sorted(p for p in FOLDER.glob("[0-9]*.md") if not p.name.startswith("0000"))
PARTS = ("## Context", "## Decision", "## Consequences")
UNUSED = "number not used"


def test_numbers_have_no_holes():
    assert [int(p.name[:4]) for p in PAGES] == list(range(1, len(PAGES) + 1))


@each_case("path", PAGES, ids=lambda p: p.stem)
def test_a_decision_has_status_date_and_its_parts(path):
    found = text(path)
    assert found.startswith(f"# {path.name[:4]} ")
    status = re.search(r"^- Status: (.+)$", found, re.MULTILINE)
    assert status, "no line `- Status: ...`"
    assert re.search(r"^- Date: 20\d\d-\d\d-\d\d$", found, re.MULTILINE)
    if status.group(1) != UNUSED:
        assert [part for part in PARTS if part not in found] == []


def test_the_index_names_every_decision():
    index = text(FOLDER / "README.md")
    assert [p.name for p in PAGES if f"]({p.name})" not in index] == []


def test_index_and_page_name_the_same_later_decision():
    index = text(FOLDER / "README.md")
    of_index = dict(re.findall(r"^\| \[(\d{4})\].*changed by (\d{4}) \|", index, re.MULTILINE))
    of_page = {}
    for page in PAGES:
        changed = re.search(r"^- Status: .*changed by \[(\d{4})\]", text(page), re.MULTILINE)
        if changed:
            of_page[page.name[:4]] = changed.group(1)
    assert of_index == of_page != {}
