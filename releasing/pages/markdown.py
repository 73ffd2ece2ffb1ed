"""From Markdown as forges read it to what the site's parser reads; links by a rule."""

from __future__ import annotations

import re
from collections.abc import Callable

_CODE = re.compile(r"(^```.*?^```[^\S\n]*$|`[^`\n]*`)", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"(\[[^\[\]]*\]\()([^()\s]+)(\))")
_BEGINS = re.compile(r"[-*] +\S|1\. +\S|\|")
_MARKED = re.compile(r"[-*] |\d+\. |[|#> ]|```|<!--")


def relink(text: str, rule: Callable[[str], str]) -> str:
    """Return the text with each relative link's target by a rule; code stays as it is."""

    def one(found: re.Match[str]) -> str:
        before, target, after = found.groups()
        inside = re.match(r"[a-z]+:", target) or target.startswith("#")
        return found.group() if inside else f"{before}{rule(target)}{after}"

    parts = _CODE.split(text)
    # a code word may stand in a link's text, so links are looked for in the whole,
    # with code hidden behind marks that no document has
    hidden = "".join(part if i % 2 == 0 else f"\x00{i}\x00" for i, part in enumerate(parts))
    linked = _LINK.sub(one, hidden)
    return re.sub(r"\x00(\d+)\x00", lambda mark: parts[int(mark.group(1))], linked)


def targets(text: str) -> list[str]:
    """Return the relative targets of a text's links, in their order."""
    found: list[str] = []

    def note(target: str) -> str:
        found.append(target)
        return target

    relink(text, note)
    return found


def apart(text: str) -> str:
    """Return the text with an empty line between a paragraph and the list or table below it.

    Forges need none; the site's parser would print both as one paragraph.
    """
    out: list[str] = []
    fenced = False
    for row in text.split("\n"):
        fence = row.startswith("```")
        if not fenced and not fence and out and _paragraph(out[-1]) and _BEGINS.match(row):
            out.append("")
        fenced ^= fence
        out.append(row)
    return "\n".join(out)


def _paragraph(row: str) -> bool:
    """Whether a row is text of a paragraph at the margin."""
    return bool(row.strip()) and not _MARKED.match(row)
