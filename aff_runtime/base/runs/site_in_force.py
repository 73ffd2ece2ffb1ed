"""Which site file was in force when, in one run.

``site.yaml`` of a run is written once, when its folder begins. What the control process takes
later is in the folder too, as ``site-HASH.yaml``, and an event CONFIG_APPLIED names that hash.
Older runs have the values alone that an edit changed, one event EDIT each: these are put into the
text that ran before.

``run.yaml`` and the events have a hash of each text too: one altered after the run is told by it.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from aff_runtime.base.runs.files import text_of, yaml_values
from aff_runtime.base.text_digest import text_digest

APPLIED, EDIT, DIFFERS = "CONFIG_APPLIED", "EDIT", "CONFIG_DIFFERS"
SITE_CHANGED = "the site file was changed"
SITE_SHA256 = "site_sha256"
"""Key of run.yaml: the hash of the text of the run's site.yaml."""
HASH_DIGITS = 12
"""Of the hash of a site file's values that names it."""
NOTED_WITHIN_S = 1.0
"""A note has the time of the newest row when the recorder gets it: what it tells of was before
that by an answer of the control process and a poll of the recorder, together less than so much."""
LARGEST_SITE = 1 << 20
_HASH = re.compile(rf"[0-9a-f]{{{HASH_DIGITS}}}")
_APPLIED = re.compile(
    rf"[0-9a-f]+: site (?P<site>[0-9a-f]{{{HASH_DIGITS}}});.*?"
    rf"(?:; text sha256 (?P<text>[0-9a-f]{{{HASH_DIGITS}}}))?"
)
_EDIT = re.compile(r"(?P<path>[\w.\[\]-]+): .* -> (?P<new>.*) \(applies at once\)")
IDENTIFIED = "a probe identified "
"""An event EDIT that begins so tells of a number of a drive that the site file leaves open."""
_RESPONSE = re.compile(
    r".*: response \S+ -> \S+ \((?P<source>probed here|brought from outside);.*"
)
_WIRE_FILE = re.compile(r".*: describes the wire, \S+ -> \S+ \(.*")
_KEY = re.compile(r"[^.\[\]]+")
_GONE = ("(absent)", "none")


@dataclass(frozen=True, slots=True, kw_only=True)
class SiteInForce:
    """What ran from a time on.

    Attributes
    ----------
    from_s : of the column ``time_s``. ``text`` : of the site file.
    said : what to know of that text; empty where it is the one that ran.
    """

    from_s: float
    text: str
    said: str = ""


def time_of(row: Mapping[str, str]) -> float:
    """Return when an event was, NaN where that cannot be read."""
    try:
        return float(row.get("time_s") or "nan")
    except ValueError:
        return math.nan


def file_of(site_hash: str) -> str:
    """Return the name of the file that holds a later site file of a run; empty of no hash."""
    short = site_hash[:HASH_DIGITS]
    return f"site-{short}.yaml" if _HASH.fullmatch(short) else ""


def text_words(text: str) -> str:
    """Return how an event CONFIG_APPLIED ends that tells which text runs."""
    return f"; text sha256 {text_digest(text)[:HASH_DIGITS]}" if text else ""


def sites_in_force(
    folder: Path,
    began: str,
    began_hash: str,
    rows: Sequence[tuple[float, Mapping[str, str]]],
    to_s: float = math.inf,
    began_sha256: str = "",
) -> tuple[SiteInForce, ...]:
    """Return every site file that ran in a run, in order; the first one from its beginning on.

    Each is read, or put together, once: some runs have hundreds of edits.

    Parameters
    ----------
    began, began_hash : text of the run's ``site.yaml``, and its hash by ``run.yaml``.
    rows : time and row of every event.
    to_s : what ran from then on, or later, is left out.
    began_sha256 : of that text, by ``run.yaml``; empty of an older run, which does not say it.
    """
    digests = _digests(rows)
    expected = {began_sha256[:HASH_DIGITS]} & set(_HASH.findall(began_sha256))
    running = SiteInForce(
        from_s=-math.inf, text=began, said=_altered("site.yaml", began, expected)
    )
    known = {began_hash[:HASH_DIGITS]: running}
    site, found, edits = began_hash[:HASH_DIGITS], [running], list[tuple[str, str]]()
    for time_s, row in rows:
        if time_s >= to_s:
            continue
        name, text = row.get("name"), row.get("text", "")
        if name == EDIT and (edit := _EDIT.fullmatch(text)):
            edits.append((edit["path"], edit["new"]))
        elif name == DIFFERS:
            edits.clear()
        elif name == APPLIED and time_s >= found[-1].from_s and (one := _APPLIED.fullmatch(text)):
            if not site and not edits:  # run.yaml has no hash: what is noted first began it
                known[one["site"]] = running
            elif one["site"] != site:
                told = digests.get(one["site"], set())
                running = _later(folder, one["site"], time_s, known, running, edits, told)
                found.append(running)
                known[one["site"]] = running
            site = one["site"]
            edits.clear()
    return tuple(found)


def changes_noted(
    sites: Sequence[SiteInForce], rows: Sequence[tuple[float, Mapping[str, str]]]
) -> list[Mapping[str, str]]:
    """Return the rows of events that tell of a change of what ran, in order.

    Edits, and notes of another site file. One of the file that ran already is noted too, where a
    control process or a recorder begins.

    Parameters
    ----------
    sites : `in_force_within` the window of these rows.
    """
    later_s = {one.from_s for one in sites[1:]}
    return [
        row
        for time_s, row in rows
        if row.get("name") == EDIT or (row.get("name") == APPLIED and time_s in later_s)
    ]


def change_words(row: Mapping[str, str]) -> str:
    """Return what an event of `changes_noted` tells of: the site file, or what was measured."""
    text = row.get("text", "")
    response = _RESPONSE.fullmatch(text)
    if text.startswith(IDENTIFIED):
        return "numbers that a probe had identified were taken"
    if response is not None and response["source"] == "probed here":
        return "the response that a probe had measured was taken"
    if response is not None:
        return "a response that no probe of the service had measured was taken"
    return "a file of the wire was changed" if _WIRE_FILE.fullmatch(text) else SITE_CHANGED


def in_force_within(
    sites: Sequence[SiteInForce], from_s: float, to_s: float
) -> tuple[SiteInForce, ...]:
    """Return what ran at ``from_s``, and what followed before ``to_s``."""
    later = [one for one in sites[1:] if from_s < one.from_s < to_s]
    at_start = [one for one in sites if one.from_s <= from_s][-1:] or list(sites[:1])
    return (*at_start, *later)


def _later(
    folder: Path,
    site: str,
    time_s: float,
    known: Mapping[str, SiteInForce],
    before: SiteInForce,
    edits: Sequence[tuple[str, str]],
    expected: set[str],
) -> SiteInForce:
    """Return what ran from ``time_s`` on: what ran earlier, a file, or what was noted of it."""
    if site in known:
        return replace(known[site], from_s=time_s)
    if text := text_of(folder / file_of(site), LARGEST_SITE):
        said = _altered(file_of(site), text, expected)
        return SiteInForce(from_s=time_s, text=text, said=said)
    since = f"from {time_s:.1f} s on another site file ran ({site}), which the run does not hold"
    edited = _edited(before.text, edits) if edits else ""
    if edited:
        said = "; ".join(filter(None, (before.said, f"{since}: its values are those noted there")))
        return SiteInForce(from_s=time_s, text=edited, said=said)
    return SiteInForce(
        from_s=time_s, text=before.text, said=f"{since}: values are those of the one before"
    )


def _digests(rows: Sequence[tuple[float, Mapping[str, str]]]) -> dict[str, set[str]]:
    """Return what was noted of the texts of each site file: two that say the same are one file."""
    found: dict[str, set[str]] = {}
    for _, row in rows:
        one = _APPLIED.fullmatch(row.get("text", "")) if row.get("name") == APPLIED else None
        if one is not None and one["text"]:
            found.setdefault(one["site"], set()).add(one["text"])
    return found


def _altered(name: str, text: str, expected: set[str]) -> str:
    """Return a sentence where a text is none of those that ran; empty where none is known."""
    found = text_digest(text)[:HASH_DIGITS]
    if not text or not expected or found in expected:
        return ""
    return (
        f"{name}: not the text that ran, altered since: its sha256 begins with {found}, expected "
        f"{' or '.join(sorted(expected))}; scales and limits are read from it as it stands: copy "
        "it anew from the gateway"
    )


def _edited(text: str, edits: Sequence[tuple[str, str]]) -> str:
    """Return a site file with other values; empty where it cannot take them."""
    try:
        data = yaml_values(text)
        for path, new in edits:
            _put(data, list(_keys(path)), new)
        _drop_empty(data)
    except (ValueError, KeyError, IndexError, TypeError):
        return ""
    return yaml.safe_dump(data, sort_keys=False, allow_unicode=True)


def _keys(path: str) -> Iterator[str | int]:
    """Yield ``actuators``, ``unwind``, ``blocks``, 0 of ``actuators.unwind.blocks[0]``."""
    for key in _KEY.finditer(path):
        is_index = path[key.start() - 1 : key.start()] == "["
        yield int(key[0]) if is_index else key[0]


def _put(data: Any, keys: Sequence[str | int], new: str) -> None:
    """Put one value at its place, sections that it needs with it; take it away where it is gone.

    Raises
    ------
    KeyError, IndexError, TypeError
        There is no such place.
    """
    for key, following in itertools.pairwise(keys):
        empty: Any = [] if isinstance(following, int) else {}
        if isinstance(data, list) and key == len(data):
            data.append(empty)
        elif isinstance(data, dict) and data.get(key) is None:
            data[key] = empty
        data = data[key]
    if new not in _GONE:
        data[keys[-1]] = _value(new)
    elif isinstance(data, dict):
        data.pop(keys[-1], None)


def _value(shown: str) -> Any:
    """Return a value as a site file has it, from how an event shows it."""
    value = yaml_values(shown)
    is_plain = isinstance(value, bool) and shown not in ("true", "false")  # the word "off"
    return shown if is_plain or isinstance(value, dict) else value


def _drop_empty(data: Any) -> None:
    """Take away rolls and blocks of which every value is gone."""
    rolls = data.get("rolls") or {}
    for name in [name for name, roll in rolls.items() if roll == {}]:
        del rolls[name]
    for actuator in (data.get("actuators") or {}).values():
        if isinstance(actuator.get("blocks"), list):
            actuator["blocks"] = [block for block in actuator["blocks"] if block != {}]
