"""The reference page and the editors' JSON Schema, both made from the models.

``python -m aff_runtime.config.reference`` writes them; a test keeps them fresh.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from pydantic_core import PydanticUndefined

from aff_runtime.config.declared import Declared, keys_of, walk
from aff_runtime.config.leaves import shown
from aff_runtime.config.models import Site
from aff_runtime.config.quantity import Section

PAGE = Path("docs/config-reference.md")
SCHEMA = Path("config/schema/site.schema.json")

_HEAD = """# Site file reference

Made from the models by `python -m aff_runtime.config.reference`; do not edit.

- A bare number is in the unit shown. Text may carry another unit of the same kind: `300 m/min`,
  `200 FPM`, `20 lbf`, `8 in`, `15 deg`, `10 ms`.
- An unknown, doubled or empty key is an error with file:line:column.
- *live*: an edit applies while a correction is active. Everything else waits for bypass.
- `<name>` is a name of your own; `[]` is one entry of a list.
"""
_TABLE = "\n| key | unit | allowed | default | live | what it does, when to change it |\n" + (
    "|---|---|---|---|---|---|\n"
)
_SLOPPY = ("gt", "ge", "lt", "le")


def reference_page() -> str:
    """Return the reference page as Markdown."""
    parts = [_HEAD, _section("Top level", Site)]
    for path, declared in walk(Site):
        inner = declared.section or (declared.item.section if declared.item else None)
        if inner is None:
            continue
        suffix = "" if declared.section else (".<name>" if declared.is_table else "[]")
        parts.append(_section(f"`{path}{suffix}`", inner))
    return "".join(parts)


def _section(title: str, section: type[Section]) -> str:
    doc = (section.__doc__ or "").strip()
    rows = "".join(_row(name, declared) for name, declared in keys_of(section).items())
    text = "\n".join(line.strip() for line in doc.splitlines())
    return f"\n## {title}\n\n{text}\n{_TABLE}{rows}"


def _row(name: str, declared: Declared) -> str:
    cells = (
        f"`{name}`",
        unit_cell(declared),
        allowed_cell(declared),
        default_cell(declared),
        "live" if declared.live else "",
        declared.description,
    )
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |\n"


def unit_cell(declared: Declared) -> str:
    """Return the unit of a key, or what kind of value it takes."""
    item = declared.item
    if declared.section is not None:
        return "section"
    if item is not None:
        inside = "section" if item.section else unit_cell(item)
        return f"{'table' if declared.is_table else 'list'} of {inside}"
    if declared.unit is not None:
        return declared.unit or ("SI per count" if declared.name == "scale" else "ratio")
    return {bool: "true/false", str: "text"}.get(declared.leaf, "word")


def allowed_cell(declared: Declared) -> str:
    """Return what a key allows: a range, choices, or a length."""
    item = declared.item
    if declared.choices:
        return ", ".join(declared.choices)
    if item is not None:
        inner = allowed_cell(item) if item.section is None else ""
        low = next((m.min_length for m in declared.metadata if hasattr(m, "min_length")), 0)
        high = next((m.max_length for m in declared.metadata if hasattr(m, "max_length")), "any")
        return f"{low} to {high} entries" + (f" of {inner}" if inner else "")
    return declared.allowed()


def default_cell(declared: Declared) -> str:
    """Return the default of a key, ``required`` when it has none."""
    info = declared.info
    if info is None or info.is_required():
        return "required"
    if info.default is PydanticUndefined:
        return "every key's own"
    return "none" if info.default is None else shown(info.default, declared)


def json_schema() -> str:
    """Return the JSON Schema of the site file, for editors."""
    schema = _cleaned(Site.model_json_schema(by_alias=True))
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "title": "AFF Runtime site file",
    }
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


def _cleaned(value: Any) -> Any:
    if isinstance(value, dict):
        numeric = "x-unit" in value
        return {
            name: _cleaned(inner)
            for name, inner in value.items()
            if not (numeric and name in _SLOPPY)
            and not (name == "title" and isinstance(inner, str))
        }
    return [_cleaned(inner) for inner in value] if isinstance(value, list) else value


def main() -> None:
    """Write both files below the present folder."""
    for path, text in ((PAGE, reference_page()), (SCHEMA, json_schema())):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        sys.stdout.write(f"wrote {path}\n")


if __name__ == "__main__":
    main()
