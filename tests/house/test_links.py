"""Documents lead where they say, keep to their length, and hold no diary."""

import re

from tests.each_case import each_case
from tests.house.documents import ROOT, anchors, documents, links, prose, text

README = ROOT / "README.md"
DIARY = (
    "two days before",
    "the day before",
    "on another machine",
    "as of commit",
    "this session",
    "yesterday",
    "last night",
    "another agent",
)
COMMIT = re.compile(r"\bcommits? +`?[0-9a-f]{7,40}\b")


@each_case("path", documents(), ids=lambda p: str(p.relative_to(ROOT)))
def test_every_relative_link_leads_somewhere(path):
    wrong = []
    for target in links(path):
        name, _, anchor = target.partition("#")
        there = (path.parent / name).resolve() if name else path
        if not there.exists():
            wrong.append(f"{target}: no such file")
        elif anchor and anchor not in anchors(there):
            wrong.append(f"{target}: no such heading")
    assert wrong == []


@each_case("path", documents(), ids=lambda p: str(p.relative_to(ROOT)))
def test_no_document_is_a_diary(path):
    flat = " ".join(prose(path).lower().split())
    assert [words for words in DIARY if words in flat] == []
    assert COMMIT.findall(flat) == []


def test_readme_fits_its_reader():
    rows = text(README).splitlines()
    assert len(rows) <= 90
    assert [row for row in rows if len(row) > 110] == []


def test_every_page_can_be_reached_from_the_readme():
    reached, ahead = set(), [README]
    while ahead:
        path = ahead.pop()
        if path in reached:
            continue
        reached.add(path)
        for target in links(path):
            there = (path.parent / target.partition("#")[0]).resolve()
            if there.suffix == ".md" and there.exists():
                ahead.append(there)
    assert [str(p.relative_to(ROOT)) for p in documents() if p.resolve() not in reached] == []


PATH = re.compile(r"`((?:docs|deploy|config|tests|data)/[\w./-]+\.\w+)`")


@each_case("path", documents(), ids=lambda p: str(p.relative_to(ROOT)))
def test_files_named_in_documents_are_there(path):
    if "notes" in path.parts or path.name == "CHANGELOG.md":
        return
    named = set(PATH.findall(text(path)))
    assert [name for name in sorted(named) if not (ROOT / name).exists()] == []
