"""Write the amended declaration, never over the old one, and the AFF block that would cancel."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from aff_runtime.base.errors import PlantError
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.declaration import Declaration, EffectEntry
from sim_plant.line.load import load_declaration
from sim_plant.refine.criteria.criteria import CRITERIA
from sim_plant.refine.model.place import Place
from sim_plant.refine.records.recording import Record
from sim_plant.refine.report.start_values import start_values
from sim_plant.refine.report.verdict import aff_blocks, declared_entries
from sim_plant.refine.search.selection import Selection

FILE = "line_amended.yaml"
BLOCK_FILE = "aff_block.yaml"
BLOCK_HEAD = """\
# for the site file: each entry (from `- roll` on) goes into the list `blocks` of an actuator,
# indented as here; it replaces the entry with the same `roll` if there is one, all others stay;
# a roller that has an actuator of its own belongs there; then run `aff-runtime check` on the file
# start: moment arm of each order for `law: shape`, tried on the roll before it is used; with
# `law: blocks` remove start and all orders but the first four
"""


def plain(value: Any) -> Any:
    """Return a value with numpy numbers, tuples and places made plain for YAML and JSON."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, Place):
        return str(value)
    if hasattr(value, "item"):
        return value.item()
    return value


def write_amended(
    source: Path,
    out: Path,
    selection: Selection,
    records: Sequence[Record],
    command: str,
    verdict: dict[str, Any],
    stated: Sequence[EffectEntry] | None = None,
) -> Path:
    """Write the declaration with its effects and provenance; return its path.

    ``stated`` are the declared effects as they stood when the first record began, if not as the
    file says.

    Raises
    ------
    PlantError
        When the file would be the declaration itself, or what was written cannot be read back.
    """
    path = out / FILE
    if path.resolve() == source.resolve():
        raise PlantError(f"{path}: is the line file itself; choose another --out")
    data = yaml.safe_load(source.read_text(encoding="utf-8"))
    fitted = dict(data.get("corrections", {}))
    for name, amount in selection.corrections.items():
        fitted[name] = fitted.get(name, 0.0) + amount
    data["corrections"] = plain(fitted)
    if stated is not None:
        data["effects"] = [e.model_dump() for e in stated]
    data["effects"] = plain([*data.get("effects", []), *declared_entries(selection.fit)])
    data["provenance"] = plain(
        {
            "made_by": command,
            "amends": source.name,
            "records": [{"path": r.path.name, "sha256": r.sha256} for r in records],
            "holdout": verdict["holdout"],
            "error_rms": verdict["residual_rms"],
            "note": "angles are those of the first record at its first row",
        }
    )
    text = "# amended by sim-plant refine: effects, provenance and corrections are new (what is\n"
    text += "# added to a declared number: a share of it; for offsets N, for the draw the\n"
    text += "# ratio itself), all else as declared\n"
    text += yaml.safe_dump(data, sort_keys=False, width=110)
    path.write_text(text, encoding="utf-8")
    load_declaration(path)
    return path


def write_block(
    out: Path,
    rows: Sequence[dict[str, Any]],
    declaration: Declaration | None = None,
    record: Record | None = None,
) -> Path | None:
    """Write the AFF blocks to paste under an actuator of the site file; None without any.

    With the ``declaration`` the block of a driven roller carries the deviations that law shape
    may start from, for every order that has one; their angles count from ``record``'s channel.
    """
    blocks = aff_blocks(rows)
    if not blocks:
        return None
    for block in blocks if declaration is not None else ():
        _add_start(block, rows, declaration, record)
    path = out / BLOCK_FILE
    head = BLOCK_HEAD + "".join(_as_roll(block["roll"], declaration) for block in blocks)
    for block in blocks:
        block["roll"] = site_name(block["roll"])
    entries = "".join(_entry(plain(block)) for block in blocks)
    path.write_text(f"{head}    blocks:\n{entries}", encoding="utf-8")
    return path


def _entry(block: dict[str, Any]) -> str:
    """Return one entry of a site file's list ``blocks``, as far in as it stands there."""
    text = yaml.safe_dump(block, sort_keys=False, default_flow_style=None, width=88)
    first, *rest = text.splitlines()
    return "".join(f"{line}\n" for line in [f"      - {first}", *(f"        {x}" for x in rest)])


def site_name(roller: str) -> str:
    """Return a roller's name as a site file takes it: small letters, digits, underscores."""
    name = re.sub(r"[^a-z0-9_]", "_", roller.lower())[:48]
    return name if name[:1].isalpha() else f"roller_{name}"[:48]


def _as_roll(name: str, declaration: Declaration | None) -> str:
    """Return the comment that says how an idler comes into the site file; none for a drive's."""
    if declaration is None or name in {drive.roller for drive in declaration.control.drives}:
        return ""
    at = declaration.body(name)
    radius_m = declaration.rollers[at].radius_m
    driven = sorted(declaration.body(drive.roller) for drive in declaration.control.drives)
    ends = [
        max((k for k in driven if k < at), default=None),
        min((k for k in driven if k > at), default=None),
    ]
    beside = " or ".join(declaration.rollers[k].name for k in ends if k is not None)
    return (
        f"# {name} has no drive: its entry goes to the actuator of {beside}, the drives before "
        f"and after it;\n# under `rolls` of the site file, with its angle channel if it has one:\n"
        f"#   {site_name(name)}: {{ radius_m: {radius_m:.6g} }}\n"
    )


def _add_start(
    block: dict[str, Any],
    rows: Sequence[dict[str, Any]],
    declaration: Declaration | None,
    record: Record | None,
) -> None:
    """Add start values to the block of a roller that a drive turns."""
    driven = {drive.roller for drive in declaration.control.drives} if declaration else set()
    if declaration is None or block["roll"] not in driven:
        return
    effects = [
        EffectEntry(
            effect=row["effect"],
            location=row["location"],
            parameters=_accepted(row["effect"], row["parameters"]),
        )
        for row in rows
        if row["location"] == block["roll"] and row["cancel"]
    ]
    first, last = min(block["orders"]), max(*block["orders"], CRITERIA.report.highest_start_order)
    orders = block["orders"] if len(block["orders"]) == 1 else range(first, last + 1)
    start = start_values(declaration, effects, block["roll"], orders, record)
    if start:
        block["orders"] = [entry["order"] for entry in start]
        block["start"] = start


def _accepted(effect: str, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters that the effect itself takes, each said once.

    A verdict names amplitude and angle beside the components they were found as.
    """
    taken = BY_NAME[effect]
    twice = {
        name
        for pair in taken.quadratures
        if pair.amplitude and pair.cos in parameters
        for name in (pair.amplitude, pair.angle)
    }
    return {k: v for k, v in parameters.items() if k in taken.parameters and k not in twice}
