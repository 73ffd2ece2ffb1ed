"""What a page loads: one script and one style for all of ours, so that it comes in few requests.

Our scripts are ES modules that take names from one another. They are put into one file when the
screen begins, each in a function of its own; nothing else is done to them, and nothing is built.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).parent
STATIC = FOLDER / "static"
# of others, as they published it, with licences and hashes beside them
VENDORED = {
    "uPlot.iife.min.js": FOLDER / "vendored" / "uplot-1.6.32" / "uPlot.iife.min.js",
    "uPlot.min.css": FOLDER / "vendored" / "uplot-1.6.32" / "uPlot.min.css",
}
STYLES = ("overview.css", "hand.css", "see.css", "card.css", "refine.css", "uPlot.min.css")
STYLE = "screen.css"
# name of a page: its own modules, in this order; what they take names from comes before them
PAGES = {
    "overview": ("overview.js", "recent.js"),
    "login": ("overview.js", "login.js"),
    "alarms": ("overview.js", "alarms.js"),
    "rolls": ("overview.js", "rolls.js"),
    "trends": ("overview.js", "trends.js"),
    "scope": ("overview.js", "scope.js"),
    "timing": ("overview.js", "timing.js"),
    "card": ("overview.js", "card.js"),
    "commission": ("overview.js", "commission.js"),
    "refine": ("overview.js", "refine.js"),
    "maintenance": ("overview.js", "maintenance.js"),
}
HAND = "hand.js"
SCRIPT, CSS = "text/javascript; charset=utf-8", "text/css; charset=utf-8"
_TAKES = re.compile(r'^import \{([^}]*)\} from "/static/(\w+\.js)";\n', re.MULTILINE)
_GIVES = re.compile(r"^export (?=(?:async function|function|const) (\w+))", re.MULTILINE)


@cache
def source(name: str) -> str:
    """Return a file as it is written."""
    return VENDORED.get(name, STATIC / name).read_text(encoding="utf-8")


def served(*, has_hand: bool) -> Mapping[str, tuple[bytes, str]]:
    """Return every file that a browser may ask for by its name: what is in it, and its kind."""
    files = {
        STYLE: ("\n".join(map(source, STYLES)).encode(), CSS),
        "icon.svg": (source("icon.svg").encode(), "image/svg+xml"),
        "uPlot.iife.min.js": (source("uPlot.iife.min.js").encode(), SCRIPT),
    }
    for page, modules in PAGES.items():
        more = (HAND,) if has_hand else ()
        first, *rest = modules
        files[f"{page}.js"] = (joined((first, *more, *rest)).encode(), SCRIPT)
    return files


def joined(modules: Iterable[str]) -> str:
    """Return modules as one, each after those that it takes names from."""
    done: dict[str, str] = {}
    for name in modules:
        _add(name, done)
    return "\n".join(done.values())


def _add(name: str, done: dict[str, str]) -> None:
    if name in done:
        return
    text = source(name)
    takes = _TAKES.findall(text)
    for _, other in takes:
        _add(other, done)
    given = ", ".join(_GIVES.findall(text))
    taken = [f"const {{{names}}} = {_own(other)};\n" for names, other in takes]
    body = _GIVES.sub("", _TAKES.sub("", text))
    assign = f"const {_own(name)} = " if given else ""
    back = f"return {{ {given} }};\n" if given else ""
    done[name] = f"{assign}(() => {{\n// {name}\n{''.join(taken)}{body}{back}}})();"


def _own(name: str) -> str:
    return f"of_{name.removesuffix('.js')}"
