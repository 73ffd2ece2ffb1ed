"""What ``mkdocs.yml`` calls while it builds: more pages, links out of ``docs``, the menu."""

from __future__ import annotations

from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from markdown import Extension, Markdown
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from pymdownx.slugs import slugify

from releasing.commands import ROOT
from releasing.pages.markdown import apart, relink
from releasing.pages.outside import link_in_site, pages_outside
from releasing.pages.pictures import FOLDER, MADE, asked_for, pictured
from releasing.pages.reference import reference_pages

SHIM = Path(__file__).with_name("iframe-worker.js")


class NestedByTwo(Extension):  # type: ignore[misc]
    """Inner lists begin two columns in, as forges have it."""

    def extendMarkdown(self, md: Markdown) -> None:
        """Tell the parser."""
        md.tab_length = 2


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Name headings as forges do, so that the documents' anchors hold."""
    config.mdx_configs.setdefault("toc", {})["slugify"] = slugify(case="lower")
    config.markdown_extensions.append(NestedByTwo())
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add pages that are no files of ``docs``; write the menu's patterns out."""
    docs = {file.src_uri: file.content_string for file in files.documentation_pages()}
    for path, text in (pages_outside(ROOT, docs) | reference_pages(ROOT)).items():
        files.append(File.generated(config, path, content=text))
    files.append(File.generated(config, f"assets/{SHIM.name}", abs_src_path=str(SHIM)))
    for name in sorted({name for text in docs.values() for name in asked_for(text)}):
        if (MADE / name).is_file():
            picture = str(MADE / name)
            files.append(File.generated(config, f"{FOLDER}/{name}", abs_src_path=picture))
    names = sorted(file.src_uri for file in files.documentation_pages())
    config.nav = _written_out(config.nav, names)
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Return a page's text for the site's parser."""
    del config, files
    here = page.file.src_uri
    linked = apart(relink(markdown, lambda target: link_in_site(here, target)))
    return pictured(linked, here, MADE)


def _written_out(menu: Any, names: list[str]) -> Any:
    """Return the menu with each pattern (``adr/0*.md``) as the pages that it fits."""
    if isinstance(menu, dict):
        return {title: _written_out(under, names) for title, under in menu.items()}
    if not isinstance(menu, list):
        return menu
    rows: list[Any] = []
    for row in menu:
        if isinstance(row, str) and "*" in row:
            named = [one for one in menu if isinstance(one, str)]
            rows += [name for name in names if fnmatch(name, row) and name not in named]
        else:
            rows.append(_written_out(row, names))
    return rows
