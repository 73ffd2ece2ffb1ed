"""The result as text for a terminal and as ``docs/results/bench.md``."""

from __future__ import annotations

import re
from collections.abc import Sequence

from benchmarks.runtime.facts import FactRow, Section
from benchmarks.runtime.reckoned import TITLE as RECKONED
from benchmarks.runtime.reckoned import reckoned
from benchmarks.runtime.targets import TITLE as TARGETS
from benchmarks.runtime.targets import targets

_DATE = re.compile(r"^Written by `[^`]*` on (\S+);", re.MULTILINE)


def text(sections: Sequence[Section]) -> str:
    """Return all tables for a terminal."""
    lines: list[str] = []
    for section in sections:
        lines += [section.title, *([f"  {section.note}"] if section.note else [])]
        for row in section.rows:
            remark = f"  ({row.remark})" if row.remark else ""
            lines.append(f"  {row.name:24} {row.value}{remark}")
        lines.append("")
    return "\n".join(lines)


def markdown(
    sections: Sequence[Section], *, date: str, title: str = "Speed", command: str = "make bench"
) -> str:
    """Return the page; it says itself which command wrote it."""
    lines = [
        f"# {title}",
        f"Written by `{command}` on {date[:10]}; numbers of another machine differ, ratios less.",
        "",
    ]
    for section in sections:
        lines += [f"## {section.title}", *([section.note] if section.note else []), ""]
        lines += [f"| | {section.head} | |", "|---|---|---|"]
        lines += [f"| {row.name} | {row.value} | {row.remark} |" for row in section.rows]
        lines.append("")
    return "\n".join(lines)


def judged(sections: Sequence[Section]) -> list[Section]:
    """Return what was measured, with targets behind the machine and what follows at the end."""
    measured = [one for one in sections if one.title not in (TARGETS, RECKONED)]
    smaller = reckoned(measured)
    return [
        *measured[:1],
        targets(measured),
        *measured[1:],
        *([smaller] if smaller is not None else []),
    ]


def read(page: str) -> tuple[str, list[Section]]:
    """Return date and tables of a page that ``markdown`` wrote.

    Raises
    ------
    ValueError
        It is no such page.
    """
    date = _DATE.search(page)
    found = [_section(part) for part in re.split(r"^## ", page, flags=re.MULTILINE)[1:]]
    if date is None or not found:
        raise ValueError("a page of this bench was expected: a date and tables")
    return date[1], found


def _section(part: str) -> Section:
    title, *rest = part.splitlines()
    cells = [
        [cell.strip() for cell in line[1:-1].split("|")] for line in rest if line.startswith("| ")
    ]
    return Section(
        title=title,
        note=rest[0],
        rows=tuple(FactRow(name=name, value=value, remark=why) for name, value, why in cells[1:]),
        head=cells[0][1],
    )
