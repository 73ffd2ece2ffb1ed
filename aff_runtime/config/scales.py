"""Scales as text (``0.1 mm``, ``4096 counts/turn``): the channel's own unit is converted to."""

from __future__ import annotations

from aff_runtime.base.channel_units import ENDINGS, unit_of_channel
from aff_runtime.base.units import UnitError, read_scale
from aff_runtime.config.findings import Finding, KeyPath
from aff_runtime.config.yaml_marks import MarkedTree, Tree

_OUTPUT_UNITS = {"velocity_reference": "m/s", "torque_reference": "N m"}
_SAY = {
    "channels": f"The channel's name does not end with its SI unit: {ENDINGS}.",
    "corrections": "The actuator of this name must say its output.",
}
_SAY["applied"] = _SAY["corrections"]
_TABLES = (
    ("gateway", "read", "channels"),
    ("gateway", "read", "applied"),
    ("gateway", "write", "corrections"),
)


def convert_scales(tree: MarkedTree) -> list[Finding]:
    """Turn every text scale of ``tree`` into SI per count; return what cannot be."""
    findings: list[Finding] = []
    for path in _TABLES:
        table = _at(tree.values, path)
        if not isinstance(table, dict):
            continue
        for name, entry in table.items():
            scale = entry.get("scale") if isinstance(entry, dict) else None
            if not isinstance(entry, dict) or not isinstance(scale, str):
                continue
            where: KeyPath = (*path, name, "scale")
            unit = _unit(tree, path, name)
            entry["scale"] = 1.0
            if not unit:
                text = f'"{scale[:40]}" needs a unit to convert to. {_SAY[path[2]]}'
                if unit is not None:
                    text = "a number has no unit. Write scale: 1."
                findings.append(tree.finding(where, text))
                continue
            try:
                entry["scale"] = read_scale(scale, unit)
            except UnitError as error:
                findings.append(tree.finding(where, str(error)))
    return findings


def _unit(tree: MarkedTree, path: tuple[str, ...], name: str) -> str | None:
    if path[2] == "channels":
        return unit_of_channel(name)
    output = _at(tree.values, ("actuators", name, "output"))
    return _OUTPUT_UNITS.get(output) if isinstance(output, str) else None


def _at(values: Tree, path: KeyPath) -> Tree:
    current: Tree = values
    for part in path:
        current = current.get(str(part)) if isinstance(current, dict) else None
    return current
