"""Which settings were in force in a window of a run, by what the service noted in its record.

A run folder holds the site file as it was when the run began. What runs later is noted each time
that a control process has taken it: the revision, the site file's, those of what was learned.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from aff_runtime.app.report.comparison.window import Window
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.runs.site_in_force import APPLIED, EDIT, time_of
from aff_runtime.base.runs.table import events_of
from aff_runtime.base.runs.window import RunWindow
from aff_runtime.config.loader import load_recorded_site
from aff_runtime.config.revision import SHORT, site_hash_of

SETTINGS = "SETTINGS"
AT_START = " started by "
"""In an event ``SETTINGS``: it names those that the run began with."""
_APPLIED = re.compile(rf"(?P<whole>[0-9a-f]+): site (?P<site>[0-9a-f]{{{SHORT}}});(?P<rest>.*)")
_RESPONSE = re.compile(r"(?P<name>\w+): response (?P<digest>[0-9a-f]+) ")
_SHAPE = re.compile(r"(?P<name>\w+): .*, shape (?P<digest>[0-9a-f]+)")


@dataclass(frozen=True, slots=True, kw_only=True)
class InForce:
    """What ran from a time on; digests of ``SHORT`` characters, empty where none is on record.

    Attributes
    ----------
    from_s : of the column ``time_s``.
    site, whole : of the site file, and with what was learned.
    responses, shapes : by actuator. ``is_said`` : the record says which they were.
    """

    from_s: float
    site: str
    whole: str = ""
    responses: Mapping[str, str] = field(default_factory=dict)
    shapes: Mapping[str, str] = field(default_factory=dict)
    is_said: bool = False


def changes_settings(row: Mapping[str, str]) -> bool:
    """Return whether an event says that other settings ran from then on."""
    name = row.get("name")
    return name == EDIT or (name == SETTINGS and AT_START not in row.get("text", ""))


def in_force(window: Window) -> InForce:
    """Return what was in force in a window.

    Raises
    ------
    RefusedError
        Settings were changed in it; or which they were cannot be told.
    """
    table = window.table
    if any(map(changes_settings, table.events)):
        raise RefusedError(f"{table.window}: settings were changed in it")
    folder = table.window.folder
    begins_s = max(table.window.from_s, float(table.columns["time_s"][0]))
    ends_s = float(table.columns["time_s"][-1])
    rows, is_whole = events_of(folder)
    applied = sorted(_applied(rows), key=lambda one: one.from_s)
    inside = [one for one in applied if begins_s < one.from_s <= ends_s]
    before = [one for one in applied if one.from_s <= begins_s]
    ran = [(one.site, one.responses) for one in (*before[-1:], *inside)]
    if any(one != ran[0] for one in ran):
        raise RefusedError(f"{table.window}: settings were changed in it")
    if before and is_whole:
        return before[-1]
    changed_s = [time_of(row) for row in rows if changes_settings(row)]
    earlier_s = [one for one in changed_s if not one > begins_s]  # one without a time too
    if earlier_s or not is_whole:
        raise RefusedError(_untold(table.window, earlier_s))
    began = site_hash_of(load_recorded_site(table.site_text, f"{folder}/site.yaml"))
    if inside:
        return inside[0]  # noted with the first rows
    return InForce(from_s=begins_s, site=began[:SHORT])


def learned_of(sentences: Sequence[str]) -> tuple[dict[str, str], dict[str, str]]:
    """Return the short digests of responses and shapes by actuator, from the service's words."""
    found = [
        {one["name"]: one["digest"] for text in sentences if (one := pattern.match(text))}
        for pattern in (_RESPONSE, _SHAPE)
    ]
    return found[0], found[1]


def _applied(rows: Sequence[Mapping[str, str]]) -> Iterator[InForce]:
    """Yield what the service noted that it runs, and when."""
    for row in rows:
        said = _APPLIED.fullmatch(row.get("text", "")) if row.get("name") == APPLIED else None
        if said is not None and math.isfinite(time_of(row)):
            responses, shapes = learned_of([text.strip() for text in said["rest"].split("; ")])
            yield InForce(
                from_s=time_of(row),
                site=said["site"],
                whole=said["whole"],
                responses=responses,
                shapes=shapes,
                is_said=True,
            )


def _untold(window: RunWindow, changed_s: Sequence[float]) -> str:
    why = f"{window}: which settings ran in it cannot be told"
    known = [f"{one:.0f} s" for one in changed_s if math.isfinite(one)]
    if known:
        return f"{why}: they were changed at {known[-1]}; name a window before that"
    return f"{why}: its events cannot be read to the end; measure anew"
