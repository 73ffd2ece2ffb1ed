"""Write the amended declaration: the owner's file with what was found, never over the old one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from aff_runtime.base.errors import PlantError
from sim_plant.base.yaml_edit import with_keys
from sim_plant.line.declared.declaration import Declaration, EffectEntry
from sim_plant.line.reading.load import LineFile, load_declaration
from sim_plant.refine.fit.gauss_newton import Fit
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.report.plain import plain
from sim_plant.refine.report.verdict import Verdict, rms_rows
from sim_plant.refine.search.selection import Selection

FILE = "line_amended.yaml"
HEAD = """\
# amended by sim-plant refine: effects, provenance and corrections are new (what is
# added to a declared number: a share of it; for offsets N, for the draw the
# ratio itself), all else as declared
"""
CHANGED = ("corrections", "effects", "provenance")
"""Keys of the line file that differ in the amended one."""


def write_amended(
    line: LineFile,
    out: Path,
    selection: Selection,
    records: Sequence[Recording],
    command: str,
    verdict: Verdict,
    stated: Sequence[EffectEntry] | None = None,
) -> Path:
    """Write the line file with its effects and provenance; return its path.

    All else stays as its owner wrote it, comments and order too. ``stated`` are the declared
    effects as they stood when the first record began, if not as the file says.

    Raises
    ------
    PlantError
        When the file would be the declaration itself, or differs, as read again, in other keys.
    """
    path = out / FILE
    if path.resolve() == line.path.resolve():
        raise PlantError(f"{path}: is the line file itself; choose another --out")
    effects = line.declaration.effects if stated is None else stated
    changes = {
        "corrections": _summed(line.declaration.corrections, selection.adjustments),
        "effects": [*map(_entry, effects), *map(_entry, found_effects(selection.fit))],
        "provenance": {
            "made_by": command,
            "amends": line.path.name,
            "records": [{"path": r.path.name, "sha256": r.sha256} for r in records],
            "holdout": verdict.holdout,
            "error_rms": rms_rows(verdict.residual_rms),
            "note": "angles are those of the first record at its first row",
        },
    }
    text = with_keys(line.text.removeprefix(HEAD), plain(changes))
    path.write_text(HEAD + text, encoding="utf-8")
    if _kept(load_declaration(path)) != _kept(line.declaration):
        raise PlantError(
            f"{path}: says something else than {line.path} beside what was found; write the "
            "line file without YAML anchors and try again"
        )
    return path


def found_effects(fit: Fit) -> list[EffectEntry]:
    """Return the fitted effects as entries of a line declaration."""
    return [e.entry() for e in fit.effects]


def _summed(declared: Mapping[str, float], found: Mapping[str, float]) -> dict[str, float]:
    """Return corrections of the file with those found added."""
    total = dict(declared)
    for name, amount in found.items():
        total[name] = total.get(name, 0.0) + amount
    return total


def _entry(entry: EffectEntry) -> dict[str, Any]:
    """Return an entry as a file has it, empty parameters left out."""
    return entry.model_dump(exclude_defaults=True)


def _kept(declaration: Declaration) -> Declaration:
    """Return a declaration with the keys that amending changes set to their defaults."""
    fields = Declaration.model_fields
    return declaration.model_copy(
        update={name: fields[name].get_default(call_default_factory=True) for name in CHANGED}
    )
