"""Pictures that the tests of the screen have made: on the pages of the site, where they exist.

A page asks for one by a line of its own, ``<!-- picture NAME.png: what it shows -->``: a forge
shows nothing there. `make test-hmi` makes them.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import Path

from releasing.commands import ROOT

MADE = ROOT / "out" / "test-hmi"
FOLDER = "pictures"
"""Where they stand in the site."""
ASKED = re.compile(r"^<!-- picture (?P<name>[\w.-]+\.png): (?P<shows>.+) -->$", re.MULTILINE)


def asked_for(text: str) -> list[str]:
    """Return the names of the pictures that a page asks for."""
    return [found["name"] for found in ASKED.finditer(text)]


def pictured(text: str, page: str, made: Path) -> str:
    """Return the text of a page of the site with the pictures that a folder has."""

    def one(found: re.Match[str]) -> str:
        name, shows = found["name"], found["shows"]
        if not (made / name).is_file():
            return ""
        there = posixpath.relpath(f"{FOLDER}/{name}", posixpath.dirname(page) or ".")
        return f"![{shows}]({there})\n\n*{shows}*"

    return ASKED.sub(one, text)
