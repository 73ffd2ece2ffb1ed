"""Read a line declaration and refuse what cannot be a line, with the place and the reason."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import yaml
from pydantic import ValidationError

from aff_runtime.base.errors import PlantError
from sim_plant.line.declaration import Declaration

LENGTH_TOLERANCE_M = 2e-3


def load_declaration(path: str | Path) -> Declaration:
    """Return the declaration in ``path``.

    Raises
    ------
    PlantError
        When the file cannot be read, is not YAML, has wrong keys or numbers, or its geometry
        contradicts itself; the message names file, key and remedy.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise PlantError(f"{path}: cannot be read ({error}). Give a line declaration.") from error
    try:
        data = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise PlantError(f"{path}: not YAML: {error}") from error
    if not isinstance(data, dict):
        raise PlantError(f"{path}: holds no keys; expected schema: web-line-declaration/1")
    try:
        declaration = Declaration.model_validate(data)
    except ValidationError as error:
        raise PlantError(_readable(path, error)) from error
    findings = consistency(declaration)
    if findings:
        raise PlantError("\n".join(f"{path}: {finding}" for finding in findings))
    return declaration


def _readable(path: str | Path, error: ValidationError) -> str:
    lines = []
    for item in error.errors():
        where = ".".join(str(part) for part in item["loc"])
        shown = repr(item.get("input"))[:60]
        lines.append(f"{path}: {where}: read {shown}; {item['msg']}")
    return "\n".join(lines)


def consistency(line: Declaration) -> list[str]:
    """Return contradictions between the parts of a declaration, as sentences."""
    names = [roller.name for roller in line.rollers]
    findings = [f"rollers: {n} appears twice" for n in sorted(set(names)) if names.count(n) > 1]
    if line.rollers[0].kind != "roll" or line.rollers[-1].kind != "roll":
        findings.append("rollers: the first and the last must be of kind roll")
    expected = list(itertools.pairwise(names))
    given = [(span.start, span.end) for span in line.spans]
    if given != expected:
        findings.append("spans: must join the rollers in web order, one span per neighbour pair")
        return findings
    findings += _geometry(line)
    findings += _references(line, names)
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
        length = math.sqrt(distance**2 - reach**2)
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
    cells = {s.roller for s in line.sensors if s.low_pass_Hz is not None}
    for loop in line.control.tension_pi:
        if loop.load_cell not in cells:
            findings.append(f"control.tension_pi.{loop.loop}: no load cell on {loop.load_cell}")
    ratio = line.control.tension_loop_sample_time_s / line.control.drive_sample_time_s
    if abs(ratio - round(ratio)) > 1e-9:
        findings.append("control: tension loop period must be a multiple of the drive period")
    return findings
