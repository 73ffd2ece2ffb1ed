"""Read a line declaration and refuse what cannot be a line, with the place and the reason."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from aff_runtime.base.yaml_places import Place
from sim_plant.base.plain_file import read_plain_text
from sim_plant.base.shipped import shipped
from sim_plant.line.declared.declaration import Declaration, LoadCell
from sim_plant.line.declared.laws import laws_findings
from sim_plant.line.reading.load_bodies import bodies_findings
from sim_plant.line.reading.load_numbers import numbers_findings
from sim_plant.line.yaml_file import LONGEST_BYTES, parse_yaml

LENGTH_TOLERANCE_M = 2e-3
MOST_TICKS = 1_000_000
"""Drive periods in one period of a tension loop."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """A YAML file, read and parsed once.

    Attributes
    ----------
    text, data : as read, and parsed.
    places : line and column of every key.
    """

    path: Path
    text: str
    data: Any
    places: Mapping[Place, tuple[int, int]]

    @property
    def shown(self) -> str:
        """The path as an error may say it."""
        return printable(str(self.path))


@dataclass(frozen=True, slots=True, kw_only=True)
class LineFile:
    """A line file as its owner wrote it, and what it declares."""

    path: Path
    text: str
    declaration: Declaration


def read_source(path: str | Path) -> Source:
    """Return the YAML file in ``path``, whatever it declares.

    Raises
    ------
    PlantError
        When it cannot be read or is not YAML.
    """
    try:
        text = read_plain_text(Path(path), LONGEST_BYTES)
    except PlantError as error:
        where = printable(str(shipped("lines")))
        raise PlantError(
            f"{error}. Give a line declaration; those that are shipped lie in {where}"
        ) from error
    data, places = parse_yaml(text, printable(str(path)))
    return Source(path=Path(path), text=text, data=data, places=places)


def line_in(source: Source) -> LineFile:
    """Return the line that a file declares.

    Raises
    ------
    PlantError
        When it has wrong keys or numbers, or its geometry contradicts itself; the message names
        file, key and remedy.
    """
    shown, data = source.shown, source.data
    if not isinstance(data, dict):
        raise PlantError(f"{shown}: holds no keys; expected schema: web-line-declaration/1")
    if "schema" not in data and "gateway" in data:
        raise PlantError(
            f"{shown}:1:1: is a site file, which aff-runtime reads. Give a line declaration, "
            f"such as {printable(str(shipped('lines/euclid.yaml')))}"
        )
    try:
        declaration = Declaration.model_validate(data)
    except ValidationError as error:
        raise PlantError(_readable(shown, error, source.places)) from error
    findings = consistency(declaration)
    if findings:
        raise PlantError("\n".join(f"{shown}: {printable(finding)}" for finding in findings))
    return LineFile(path=source.path, text=source.text, declaration=declaration)


def load_line(path: str | Path) -> LineFile:
    """Return the line file in ``path``; PlantError as `read_source` and `line_in`."""
    return line_in(read_source(path))


def load_declaration(path: str | Path) -> Declaration:
    """Return the declaration in ``path``; PlantError as `read_source` and `line_in`."""
    return load_line(path).declaration


def _readable(shown: str, error: ValidationError, places: Mapping[Place, tuple[int, int]]) -> str:
    lines = []
    for item in error.errors():
        named = at = _without_kind(item["loc"])
        while at not in places:  # a missing key stands where its section does
            at = at[:-1]
        line, column = places[at]
        where, given = printable(".".join(map(str, named)), 200), item.get("input")
        said = item["msg"] + _hint(given)
        if item["type"] == "missing":
            lines.append(f"{shown}:{line}:{column}: {where}: {said}")
        else:
            lines.append(f"{shown}:{line}:{column}: {where}: read {repr(given)[:60]}; {said}")
    return "\n".join(lines)


def _without_kind(at: tuple[int | str, ...]) -> tuple[int | str, ...]:
    """Return a place without the kind of sensor or dancer that stands between index and key."""
    return (*at[:2], *at[3:]) if at[:1] in (("sensors",), ("dancers",)) else at


def _hint(given: object) -> str:
    """Return how to write a number that YAML reads as text, such as 1e-3."""
    try:
        return f"; write {float(given)!r} without quotes" if isinstance(given, str) else ""
    except ValueError:
        return ""


def consistency(line: Declaration) -> list[str]:
    """Return contradictions between the parts of a declaration, as sentences."""
    names = [roller.name for roller in line.rollers]
    findings = _twice("rollers", names)
    if line.rollers[0].kind != "roll" or line.rollers[-1].kind != "roll":
        findings.append("rollers: the first and the last must be of kind roll")
    findings += [
        f"rollers.{r.name}.kind: read 'roll'; only the first and the last can be"
        for r in line.rollers[1:-1]
        if r.kind == "roll"
    ]
    expected = list(itertools.pairwise(names))
    given = [(span.start, span.end) for span in line.spans]
    if given != expected:
        findings.append("spans: must join the rollers in web order, one span per neighbour pair")
        return findings
    findings += _geometry(line)
    findings += _references(line, names)
    if not findings:
        findings += laws_findings(line)
        findings += bodies_findings(line) or numbers_findings(line)
    return findings


def _geometry(line: Declaration) -> list[str]:
    findings = []
    for index, span in enumerate(line.spans):
        a, b = line.rollers[index], line.rollers[index + 1]
        distance = math.hypot(b.center_x_m - a.center_x_m, b.center_y_m - a.center_y_m)
        crossed = a.rotation != b.rotation
        reach = a.radius_m + b.radius_m if crossed else abs(a.radius_m - b.radius_m)
        if distance <= reach:
            findings.append(f"spans.{span.start}-{span.end}: the two bodies overlap")
            continue
        length = math.sqrt((distance - reach) * (distance + reach))  # a square can overflow
        if abs(length - span.length_m) > LENGTH_TOLERANCE_M:
            findings.append(
                f"spans.{span.start}-{span.end}.length_m: read {span.length_m}, but the centres "
                f"and radii give {length:.5f}; correct one of them"
            )
    return findings


def _references(line: Declaration, names: list[str]) -> list[str]:
    findings = []
    users = [("control.drives", d.roller) for d in line.control.drives]
    users += [("control.tension_pi", t.acts_on) for t in line.control.tension_pi]
    users += [("control.tension_pi", t.load_cell) for t in line.control.tension_pi]
    users += [("sensors." + s.channel, s.roller) for s in line.sensors]
    for where, name in users:
        if name not in names:
            findings.append(f"{where}: roller {name} does not exist")
    findings += _twice("control.drives", [d.roller for d in line.control.drives])
    findings += _twice("sensors", [s.channel for s in line.sensors])
    cells = {s.roller for s in line.sensors if isinstance(s, LoadCell)}
    findings += [
        f"sensors: a load cell needs a span on both sides, {name} has one"
        for name in (names[0], names[-1])
        if name in cells
    ]
    driven = {drive.roller for drive in line.control.drives}
    for loop in line.control.tension_pi:
        if loop.load_cell not in cells:
            findings.append(f"control.tension_pi.{loop.loop}: no load cell on {loop.load_cell}")
        if loop.acts_on not in driven:
            findings.append(f"control.tension_pi.{loop.loop}: no drive on {loop.acts_on}")
    ratio = line.control.tension_loop_sample_time_s / line.control.drive_sample_time_s
    if not ratio < MOST_TICKS or abs(ratio - round(ratio)) > 1e-9:
        findings.append(
            "control: tension loop period must be a multiple of the drive period, "
            f"below {MOST_TICKS} of it"
        )
    return findings


def _twice(where: str, names: list[str]) -> list[str]:
    return [f"{where}: {n} appears twice" for n in sorted(set(names)) if names.count(n) > 1]
