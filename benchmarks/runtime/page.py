"""The result as text for a terminal and as ``docs/results/bench.md``."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.runtime.facts import Section


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
        lines += ["| | measured | |", "|---|---|---|"]
        lines += [f"| {row.name} | {row.value} | {row.remark} |" for row in section.rows]
        lines.append("")
    return "\n".join(lines)
