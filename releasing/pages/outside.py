"""Files outside of ``docs`` that pages lead to: they are pages of the site too."""

from __future__ import annotations

import posixpath
from pathlib import Path

from releasing.pages.markdown import targets

FOLDER = "repository"
"""Where they stand in the site."""

LANGUAGES = {".py": "python", ".yaml": "yaml", ".yml": "yaml", ".sh": "sh", ".st": "pascal"}
LANGUAGES |= {".service": "ini", ".conf": "ini", ".toml": "toml", ".c": "c"}


def place_in_repository(page: str) -> str:
    """Return a file's path in the repository from its path in the site's sources."""
    if not page.startswith(f"{FOLDER}/"):
        return f"docs/{page}"
    inside = page.removeprefix(f"{FOLDER}/")
    return inside.removesuffix(".shown.md")


def place_in_site(path: str) -> str:
    """Return a file's path in the site's sources from its path in the repository."""
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    return f"{FOLDER}/{path}" if path.endswith(".md") else f"{FOLDER}/{path}.shown.md"


def led_to(page: str, target: str) -> tuple[str, str]:
    """Return the path in the repository that a page's link leads to, and its anchor."""
    name, _, anchor = target.partition("#")
    folder = posixpath.dirname(place_in_repository(page))
    return posixpath.normpath(posixpath.join(folder, name)), anchor


def link_in_site(page: str, target: str) -> str:
    """Return a link's target among the site's sources."""
    path, anchor = led_to(page, target)
    here = posixpath.dirname(page)
    there = posixpath.relpath(place_in_site(path), here or ".")
    return f"{there}#{anchor}" if anchor else there


def pages_outside(root: Path, docs: dict[str, str]) -> dict[str, str]:
    """Return every page of the site that is no file of ``docs``: its path and its Markdown.

    Parameters
    ----------
    root
        The repository.
    docs
        Markdown of every page below ``docs``, by its path there.
    """
    found: dict[str, str] = {}
    ahead = list(docs.items())
    while ahead:
        page, text = ahead.pop()
        for target in targets(text):
            path, _ = led_to(page, target)
            place = place_in_site(path)
            file = root / path
            if path.startswith(("docs/", "../")) or place in found or not file.is_file():
                continue
            shown = file.read_text(encoding="utf-8")
            found[place] = shown if path.endswith(".md") else _as_page(path, shown)
            if path.endswith(".md"):
                ahead.append((place, shown))
    return found


def _as_page(path: str, text: str) -> str:
    """Return a page that shows a file of code."""
    fence = "`" * 5
    language = LANGUAGES.get(Path(path).suffix, "text")
    return f"# {path}\n\n{fence}{language}\n{text.rstrip()}\n{fence}\n"
