"""Scales written with a unit (``0.1 mm``): the unit to convert to is the channel's own."""

from __future__ import annotations

from aff_runtime.base.units import UnitError, read_number
from aff_runtime.config.channel_units import unit_of_channel
from aff_runtime.config.findings import Finding, KeyPath
from aff_runtime.config.yaml_marks import MarkedTree, Tree

_OUTPUT_UNITS = {"velocity_reference": "m/s", "torque_reference": "N m"}


def convert_scales(tree: MarkedTree) -> list[Finding]:
    """Turn every text scale of ``tree`` into SI per count; return what cannot be."""
    findings: list[Finding] = []
    for path in (("gateway", "read", "channels"), ("gateway", "write", "corrections")):
        table = _at(tree.values, path)
        if not isinstance(table, dict):
            continue
        for name, entry in table.items():
            unit = _unit(tree, path, name)
            if unit is None or not isinstance(entry, dict):
                continue
            scale = entry.get("scale")
            if isinstance(scale, str):
                where: KeyPath = (*path, name, "scale")
                try:
                    entry["scale"] = _read(scale, unit)
                except UnitError as error:
                    findings.append(tree.finding(where, str(error)))
                    entry["scale"] = 1.0
    return findings


def _read(text: str, unit: str) -> float:
    return read_number(text, unit)


def _unit(tree: MarkedTree, path: KeyPath, name: str) -> str | None:
    if path[1] == "read":
        return unit_of_channel(name)
    output = _at(tree.values, ("actuators", name, "output"))
    return _OUTPUT_UNITS.get(output) if isinstance(output, str) else None


def _at(values: Tree, path: KeyPath) -> Tree:
    current: Tree = values
    for part in path:
        current = current.get(str(part)) if isinstance(current, dict) else None
    return current
