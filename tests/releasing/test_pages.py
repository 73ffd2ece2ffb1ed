"""The site of the documents: whole, without a broken link, and without another host."""

from __future__ import annotations

import json
import os
import posixpath
import re
import subprocess
import sys
from fnmatch import fnmatch
from html.parser import HTMLParser
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import unquote

import pytest

from releasing.commands import ROOT
from releasing.pages.markdown import apart, relink, targets
from releasing.pages.outside import link_in_site, pages_outside
from releasing.pages.pictures import asked_for, pictured
from releasing.pages.reference import offered, reference_pages
from tests import quick_yaml
from tests.each_case import each_case

# a build takes some 15 s of a core, on a busy machine minutes
pytestmark = pytest.mark.timeout(600)
WITHOUT = "the extra `docs` is not installed: pip install -e '.[docs]', or make site"
needs_mkdocs = pytest.mark.skipif(
    find_spec("mkdocs") is None or find_spec("mkdocstrings") is None, reason=WITHOUT
)
LOADED = {"script": "src", "img": "src", "iframe": "src", "source": "src", "link": "href"}
FOREIGN = re.compile(r"^(?:[a-z]+:)?//")


def menu(rows) -> list[str]:
    """Return every page and pattern of the menu."""
    if isinstance(rows, str):
        return [rows]
    inside = rows.values() if isinstance(rows, dict) else rows
    return [name for row in inside for name in menu(row)]


NAV = menu(quick_yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))["nav"])
PAGES = sorted(str(p.relative_to(ROOT / "docs")) for p in (ROOT / "docs").rglob("*.md"))


@each_case("page", PAGES)
def test_every_page_is_in_the_menu(page):
    assert [name for name in NAV if fnmatch(page, name)] != []


def test_the_menu_names_no_page_twice_and_none_that_is_not_there():
    plain = [name for name in NAV if "*" not in name]
    assert sorted(set(plain)) == sorted(plain)
    docs = {page: (ROOT / "docs" / page).read_text(encoding="utf-8") for page in PAGES}
    there = {*PAGES, *pages_outside(ROOT, docs), *reference_pages(ROOT)}
    assert [name for name in NAV if not any(fnmatch(page, name) for page in there)] == []


def test_links_out_of_docs_become_pages_of_the_site():
    assert link_in_site("technician/card.md", "../../deploy/RUNBOOK.md#install") == (
        "../repository/deploy/RUNBOOK.md#install"
    )
    assert link_in_site("trust.md", "../tests/house/test_links.py") == (
        "repository/tests/house/test_links.py.shown.md"
    )
    assert link_in_site("repository/deploy/RUNBOOK.md", "../docs/screen.md") == "../../screen.md"
    assert link_in_site("repository/deploy/RUNBOOK.md", "plc/COMMISSIONING.md") == (
        "plc/COMMISSIONING.md"
    )


def test_a_linked_page_brings_the_pages_that_it_links(tmp_path):
    (tmp_path / "deploy").mkdir()
    (tmp_path / "deploy" / "BOOK.md").write_text("[code](run.sh) [gone](no.md) [up](../../x.md)")
    (tmp_path / "deploy" / "run.sh").write_text("echo ```\n")
    found = pages_outside(tmp_path, {"page.md": "[book](../deploy/BOOK.md) [x](other.md)"})
    assert sorted(found) == ["repository/deploy/BOOK.md", "repository/deploy/run.sh.shown.md"]
    shown = found["repository/deploy/run.sh.shown.md"]
    assert shown == "# deploy/run.sh\n\n`````sh\necho ```\n`````\n"


def test_links_in_code_and_to_other_hosts_stay():
    text = "[a](x.md) `[b](y.md)` [`c`](z.md#q) [d](https://e.org) [f](#g)\n```\n[h](i.md)\n```\n"
    assert targets(text) == ["x.md", "z.md#q"]
    changed = relink(text, str.upper)
    assert changed == text.replace("(x.md)", "(X.MD)").replace("(z.md#q)", "(Z.MD#Q)")


def test_a_list_or_table_right_below_a_paragraph_is_set_apart():
    assert apart("text\n- one\n- two") == "text\n\n- one\n- two"
    assert apart("text\n| a |\n|---|") == "text\n\n| a |\n|---|"
    assert apart("- one\n  more\n- two") == "- one\n  more\n- two"
    fenced = "```\ntext\n- one\n```"
    assert apart(fenced) == fenced


PICTURE = "text\n\n<!-- picture look-1.png: A line at work -->\n\nmore\n"


def test_a_picture_of_the_tests_stands_where_a_page_asks_for_it(tmp_path):
    assert asked_for(PICTURE) == ["look-1.png"]
    assert pictured(PICTURE, "screen.md", tmp_path) == "text\n\n\n\nmore\n"
    (tmp_path / "look-1.png").write_bytes(b"")
    shown = "![A line at work](../pictures/look-1.png)\n\n*A line at work*"
    assert pictured(PICTURE, "tester/x.md", tmp_path) == f"text\n\n{shown}\n\nmore\n"


def test_the_tests_of_the_screen_make_every_picture_that_a_page_asks_for():
    browser = ROOT / "tests" / "aff_hmi" / "browser"
    code = "".join(path.read_text(encoding="utf-8") for path in browser.glob("*.py"))
    patterns = [
        re.compile(re.sub(r"\\{[^}]*\\}", "[A-Za-z0-9-]+", re.escape(name)))
        for name in re.findall(r'pictures / f?"([^"]+\.png)"', code)
    ]
    names = {n for page in PAGES for n in asked_for((ROOT / "docs" / page).read_text("utf-8"))}
    assert names != set()
    assert [n for n in sorted(names) if not any(p.fullmatch(n) for p in patterns)] == []


def test_the_code_reference_has_a_page_for_each_package_with_public_modules(tmp_path):
    init = tmp_path / "__init__.py"
    init.write_text('"""A package."""\n\n__all__ = ["one", "function"]\n')
    (tmp_path / "one.py").write_text("")
    assert offered(init) == ["one"]
    pages = reference_pages(ROOT)
    assert "::: aff_runtime.core.laws.catalogue\n" in pages["code/aff_runtime.core.laws.md"]
    assert "aff_runtime.core.md" in pages["code/index.md"]


class Page(HTMLParser):
    """What a page names, links to, and makes a browser load."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.names: set[str] = set()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        found = dict(attrs)
        self.names |= {found[key] for key in ("id", "name") if found.get(key)}
        if tag == "a" and found.get("href"):
            self.links.append(found["href"])
        if tag in LOADED and found.get(LOADED[tag]) and found.get("rel") != "canonical":
            self.loads.append(found[LOADED[tag]])


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """Build the site as `make site` does."""
    out = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-P", "-m", "releasing.pages", "--out", str(out)]
    ours = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "PYTHONPATH": ours}
    done = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return out


@pytest.fixture(scope="module")
def pages(site) -> dict[str, Page]:
    return {
        str(path.relative_to(site)): Page(path.read_text(encoding="utf-8"))
        for path in sorted(site.rglob("*.html"))
    }


@needs_mkdocs
def test_a_browser_loads_nothing_from_another_host(site, pages):
    foreign = {load for page in pages.values() for load in page.loads if FOREIGN.match(load)}
    assert foreign == set()
    for sheet in site.rglob("*.css"):
        text = sheet.read_text(encoding="utf-8")
        named = re.findall(r"url\(\s*['\"]?([^'\")\s]+)|@import\s+['\"]([^'\"]+)", text)
        assert [one for pair in named for one in pair if FOREIGN.match(one)] == [], sheet


@needs_mkdocs
def test_every_link_and_every_loaded_file_of_the_site_is_in_it(site, pages):
    wrong = []
    for name, page in pages.items():
        if name == "404.html":  # its links begin at the host's root
            continue
        for target in page.links + page.loads:
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            path = unquote(path.partition("?")[0])
            there = posixpath.normpath(posixpath.join(posixpath.dirname(name), path))
            there = name if not path else there
            if not (site / there).exists():
                wrong.append(f"{name}: {target}: no such file")
            elif anchor and there in pages and unquote(anchor) not in pages[there].names:
                wrong.append(f"{name}: {target}: no such heading")
    assert wrong == []


@needs_mkdocs
def test_no_list_or_table_of_a_page_is_printed_as_running_text(site, pages):
    wrong = []
    for name in pages:
        if name.startswith("code/"):
            continue
        text = (site / name).read_text(encoding="utf-8")
        for paragraph in re.findall(r"<p>(.*?)</p>", text, re.DOTALL):
            if found := re.search(r"\n *(?:[-*] |1\. |\|).*", paragraph):
                wrong.append(f"{name}: {found.group().strip()[:60]}")
    assert wrong == []


@needs_mkdocs
def test_pages_can_be_searched_and_the_reference_of_code_is_left_out(site):
    found = json.loads((site / "search" / "search_index.json").read_text(encoding="utf-8"))
    places = {row["location"].partition("#")[0] for row in found["docs"]}
    assert {"operator.html", "technician/tuning.html", "glossary.html"} <= places
    assert [place for place in places if place.startswith("code/aff_runtime")] == []
    assert (site / "search" / "search_index.js").exists(), "search needs a server"
