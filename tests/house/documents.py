"""The documents of the repository, with their links and headings."""

import re
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PLACES = ("*.md", "docs/**/*.md", "deploy/**/*.md", "data/**/*.md")
_FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
_CODE = re.compile(r"`[^`\n]*`")
_LINK = re.compile(r"\[[^\[\]]*\]\(([^()\s]+)\)")
_HEADING = re.compile(r"^#+ +(.*?) *$", re.MULTILINE)


def documents():
    """Return every Markdown file of the repository."""
    return sorted({path for place in PLACES for path in ROOT.glob(place)})


@cache
def text(path):
    """Return a document's text."""
    return path.read_text(encoding="utf-8")


def prose(path):
    """Return a document's text without fenced blocks and code."""
    return _CODE.sub("", _FENCE.sub("", text(path)))


def links(path):
    """Return the targets of a document's links that stay in the repository."""
    targets = _LINK.findall(prose(path))
    return [t for t in targets if not re.match(r"[a-z]+:", t)]


@cache
def anchors(path):
    """Return the anchors of a document's headings, as forges make them."""
    found = []
    for heading in _HEADING.findall(_FENCE.sub("", text(path))):
        shown = re.sub(r"\[([^\[\]]*)\]\([^()]*\)", r"\1", heading)
        name = re.sub(r"[^\w\- ]", "", shown.lower()).replace(" ", "-")
        count = sum(one == name or one.startswith(f"{name}-dup") for one in found)
        found.append(name if not count else f"{name}-{count}")
    return frozenset(found)
