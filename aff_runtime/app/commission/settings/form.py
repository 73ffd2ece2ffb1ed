"""The site file as a form: from the models what may be set, from the text what is written."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Iterator, Mapping

from aff_runtime.app.commission.views.of_settings import (
    SaidOfSetting,
    SettingsSection,
    SettingView,
)
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.printable import printable
from aff_runtime.config.declared import Declared
from aff_runtime.config.edited_text import EditedText
from aff_runtime.config.findings import KeyPath, dotted
from aff_runtime.config.leaves import Leaf, leaves
from aff_runtime.config.models import Site
from aff_runtime.config.reference import allowed_cell, default_cell

MOST_DIFF_LINES = 400
# FILE:LINE:COLUMN  PATH: TEXT
_FINDING = re.compile(
    r".*?:(?P<line>\d+):(?P<column>\d+)  "
    r"(?:(?P<path>[A-Za-z_][\w.]*(?:\[\d+\][\w.]*)*): )?(?P<text>.*)",
    re.DOTALL,
)
WAITS = "(waits for bypass)"


def sections(site: Site, text: str) -> tuple[SettingsSection, ...]:
    """Return every setting of a site, in the order of the models.

    Parameters
    ----------
    text : of the site file that says this site.
    """
    edited = EditedText(text)
    rolls: dict[KeyPath, str] = {}
    found: dict[KeyPath, list[SettingView]] = {}
    for leaf in leaves(site):
        where = leaf.path[:-1]
        if leaf.path[-1] == "roll" and isinstance(where[-1], int):
            rolls[where] = str(leaf.value)
        found.setdefault(where, []).append(_setting(leaf, edited))
    return tuple(
        SettingsSection(path=dotted(path), roll=_roll_of(path, rolls), settings=tuple(settings))
        for path, settings in found.items()
    )


def _roll_of(path: KeyPath, rolls: Mapping[KeyPath, str]) -> str:
    """Return the roll that an item of a list is about, or the one that it stands in."""
    above = (path[:length] for length in range(len(path), 0, -1))
    return next((rolls[one] for one in above if one in rolls), "")


def _can_edit(leaf: Leaf, edited: EditedText) -> bool:
    """Return whether a setting stands in the file as one value, or can be written into it."""
    if edited.written(leaf.path) is not None:
        return True
    item = leaf.declared.item
    is_value = leaf.declared.section is None and not leaf.declared.is_table
    is_value = is_value and (item is None or item.section is None)
    return is_value and edited.can_add(leaf.path)


def _setting(leaf: Leaf, edited: EditedText) -> SettingView:
    declared, written = leaf.declared, edited.written(leaf.path)
    return SettingView(
        path=dotted(leaf.path),
        name=str(leaf.path[-1]),
        kind=_kind(declared),
        unit=declared.unit or "",
        allowed=allowed_cell(declared),
        choices=("true", "false") if declared.leaf is bool else declared.choices,
        default=default_cell(declared),
        shown=leaf.shown,
        written=written or "",
        live=declared.live,
        can_edit=_can_edit(leaf, edited),
        help=declared.description,
    )


def _kind(declared: Declared) -> str:
    if declared.item is not None:
        return "list"
    if declared.choices:
        return "choice"
    if declared.leaf is bool:
        return "flag"
    return "number" if declared.unit is not None else "text"


def edits_in(lines: str) -> Mapping[str, str]:
    """Return what is to be changed, a line ``PATH: VALUE`` each.

    Raises
    ------
    RefusedError
        A line is none of this kind, or a path stands twice.
    """
    found: dict[str, str] = {}
    for line in lines.splitlines():
        path, mark, value = line.partition(": ")
        if not mark or path in found:
            raise RefusedError(f"{line[:80]}: a line PATH: VALUE for each setting is needed")
        found[path] = value.strip()
    if not found:
        raise RefusedError("nothing is to be changed")
    return found


def text_with_edits(site: Site, text: str, lines: str) -> str:
    """Return a site file's text with settings changed; every other byte stays.

    Raises
    ------
    AffError
        One is no setting, has no place in the file as one value, or what is to be written is no
        single value.
    """
    edited = EditedText(text)
    declared = {dotted(leaf.path): leaf for leaf in leaves(site)}
    values: dict[KeyPath, str] = {}
    for path, value in edits_in(lines).items():
        if path not in declared:
            raise RefusedError(f"{path}: this site file has no such setting")
        if not _can_edit(declared[path], edited):
            raise RefusedError(f"{path}: stands there as no single value; edit the file itself")
        values[declared[path].path] = value
    return edited.with_values(values)


def said_in(findings: Iterable[str]) -> tuple[SaidOfSetting, ...]:
    """Return what a check says, by the settings that it is about."""
    return tuple(_said(findings))


def _said(findings: Iterable[str]) -> Iterator[SaidOfSetting]:
    for finding in findings:
        match = _FINDING.fullmatch(finding)
        if match is None:
            yield SaidOfSetting(path="", text=finding)
        else:
            yield SaidOfSetting(
                path=match["path"] or "",
                text=match["text"],
                line=int(match["line"]),
                column=int(match["column"]),
            )


def is_finding(line: str) -> bool:
    """Return whether a line is one of a check, with its place in a file."""
    return _FINDING.fullmatch(line) is not None


def lines_between(before: str, after: str) -> tuple[str, ...]:
    """Return the lines that differ, marked, with two of what is around them.

    A character of the file that turns or hides others stands there as what it is.
    """
    lines = difflib.unified_diff(before.splitlines(), after.splitlines(), lineterm="", n=2)
    differ = [printable(line) for line in lines if not line.startswith(("---", "+++"))]
    return tuple(differ[:MOST_DIFF_LINES])
