"""Write the amended declaration, never over the old one, and the AFF block that would cancel."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from aff_runtime.base.errors import PlantError
from sim_plant.line.load import load_declaration
from sim_plant.refine.record import Record
from sim_plant.refine.trace import Trace
from sim_plant.refine.verdict import aff_blocks, declared_entries

FILE = "line_amended.yaml"
BLOCK_FILE = "aff_block.yaml"


def plain(value: Any) -> Any:
    """Return a value with numpy numbers and tuples made plain for YAML and JSON."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if hasattr(value, "item"):
        return value.item()
    return value


def write_amended(
    source: Path, out: Path, trace: Trace, records: Sequence[Record], command: str,
    verdict: dict[str, Any],
) -> Path:  # fmt: skip
    """Write the declaration with its effects and provenance; return its path.

    Raises
    ------
    PlantError
        When the file would be the declaration itself, or what was written cannot be read back.
    """
    path = out / FILE
    if path.resolve() == source.resolve():
        raise PlantError(f"{path}: is the line file itself; choose another --out")
    data = yaml.safe_load(source.read_text(encoding="utf-8"))
    data["effects"] = [*data.get("effects", []), *plain(declared_entries(trace.fit))]
    data["provenance"] = plain({
        "made_by": command, "amends": source.name,
        "records": [{"path": r.path.name, "sha256": r.sha256} for r in records],
        "holdout": verdict["holdout"], "error_rms": verdict["residual_rms"],
        "note": "angles are those of the first record at its first row",
    })  # fmt: skip
    text = "# amended by sim-plant refine: effects and provenance are new, all else as declared\n"
    text += yaml.safe_dump(data, sort_keys=False, width=110)
    path.write_text(text, encoding="utf-8")
    load_declaration(path)
    return path


def write_block(out: Path, rows: Sequence[dict[str, Any]]) -> Path | None:
    """Write the AFF blocks to paste under an actuator of the site file; None without any."""
    blocks = aff_blocks(rows)
    if not blocks:
        return None
    path = out / BLOCK_FILE
    text = "# paste under `actuators.<name>.blocks` of the site file; weights start at 0\n"
    path.write_text(text + yaml.safe_dump({"blocks": plain(blocks)}, sort_keys=False),
                    encoding="utf-8")  # fmt: skip
    return path
