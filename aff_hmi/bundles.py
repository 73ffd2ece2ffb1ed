"""What a page loads: one script and one style sheet of our own, so that it needs few requests.

Our scripts are ES modules that import from one another. When the screen starts, those of a page
are joined into one file, each inside a function of its own; the text is not changed otherwise.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType

FOLDER = Path(__file__).parent
STATIC = FOLDER / "static"
# as published by others; licences and hashes are beside them
VENDORED = {
    "uPlot.iife.min.js": FOLDER / "vendored" / "uplot-1.6.32" / "uPlot.iife.min.js",
    "uPlot.min.css": FOLDER / "vendored" / "uplot-1.6.32" / "uPlot.min.css",
}
STYLES = (
    "overview.css",
    "hand.css",
    "see.css",
    "card.css",
    "refine.css",
    "settings.css",
    "uPlot.min.css",
)
STYLE = "screen.css"
# name of a page: its own modules, in this order; what they import comes before them
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
    "settings": ("overview.js", "settings.js"),
    "refine": ("overview.js", "refine.js"),
    "maintenance": ("overview.js", "maintenance.js"),
}
HAND = "hand.js"
SCRIPT, CSS = "text/javascript; charset=utf-8", "text/css; charset=utf-8"
_IMPORT = re.compile(r'^import \{([^}]*)\} from "/static/(\w+\.js)";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async function|function|const) (\w+))", re.MULTILINE)


@cache
def source(name: str) -> str:
    """Return a file as it is written."""
    return VENDORED.get(name, STATIC / name).read_text(encoding="utf-8")


@cache
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
    return MappingProxyType(files)


def joined(modules: Iterable[str]) -> str:
    """Return modules as one script, each after those that it imports."""
    done: dict[str, str] = {}
    for name in modules:
        _add(name, done)
    return "\n".join(done.values())


def _add(name: str, done: dict[str, str]) -> None:
    if name in done:
        return
    imports, wrapped = _wrapped(name)
    for other in imports:
        _add(other, done)
    done[name] = wrapped


@cache
def _wrapped(name: str) -> tuple[tuple[str, ...], str]:
    """Return what a module imports from, and the module inside a function of its own."""
    text = source(name)
    imports = _IMPORT.findall(text)
    exported = ", ".join(_EXPORT.findall(text))
    taken = [(names.replace(" as ", ": "), other) for names, other in imports]
    head = "".join(f"const {{{names}}} = {_variable(other)};\n" for names, other in taken)
    body = _EXPORT.sub("", _IMPORT.sub("", text))
    tail = f"return {{ {exported} }};\n" if exported else ""
    inside = f"// {name}\n{head}{body}{tail}"
    call = f"(() => {{\n{inside}}})();"
    whole = f"const {_variable(name)} = {call}" if exported else call
    return tuple(other for _, other in imports), whole


def _variable(name: str) -> str:
    """Return the name under which other modules of the script find what a module exports."""
    return f"of_{name.removesuffix('.js')}"
