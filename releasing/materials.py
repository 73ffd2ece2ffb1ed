"""Bill of materials (CycloneDX) and licences of what each lock installs."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from releasing.commands import run, tool
from releasing.lock import EXTRAS, LOCKS, pins

PRODUCT = "aff-runtime"
NOT_STATED = "not stated"


def install_all(wheel: Path, folder: Path) -> Path:
    """Install the wheel with every lock into an environment; return its Python."""
    uv, python = tool("uv"), folder / "bin" / "python"
    run([uv, "venv", "--quiet", "--python", tool("python"), str(folder)])
    locks = [word for name in EXTRAS for word in ("-r", str(LOCKS / f"{name}.txt"))]
    into = [uv, "pip", "install", "--quiet", "--python", str(python)]
    run([*into, "--require-hashes", "--only-binary", ":all:", *locks])
    run([*into, "--no-deps", str(wheel)])
    return python


def bill(python: Path) -> dict[str, Any]:
    """Return the bill of materials of an environment, without time and serial number."""
    command = [tool("cyclonedx-py"), "environment", "--output-reproducible", "--of", "JSON"]
    said = json.loads(run([*command, str(python)]))
    assert isinstance(said, dict)
    return said


def part_of(whole: dict[str, Any], lock: str) -> dict[str, Any]:
    """Return the bill of one lock: its packages and the product, with what depends on what."""
    names = {plain(re.split(r"[=\s;]", pin)[0]) for pin in pins(LOCKS / f"{lock}.txt")}
    own = [_without_place(c) for c in whole["components"] if plain(c["name"]) == PRODUCT]
    kept = [item for item in whole["components"] if plain(item["name"]) in names]
    there = {item["bom-ref"] for item in (*own, *kept)}
    rows = [
        {**row, "dependsOn": [ref for ref in row.get("dependsOn", ()) if ref in there]}
        for row in whole.get("dependencies", ())
        if row["ref"] in there
    ]
    metadata = {**whole["metadata"], "component": own[0]}
    return {**whole, "metadata": metadata, "components": kept, "dependencies": rows}


def _without_place(component: dict[str, Any]) -> dict[str, Any]:
    """Return the product's component with its wheel by name: the folder is another every time."""
    rows = [
        {**row, "url": f"file:{row['url'].rpartition('/')[2]}"}
        if row["url"].startswith("file:")
        else row
        for row in component.get("externalReferences", ())
    ]
    return {**component, "externalReferences": rows}


def plain(name: str) -> str:
    """Return a package's name as indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def licences(component: dict[str, Any]) -> str:
    """Return the licences that a package states, in its own words."""
    said = []
    for row in component.get("licenses", ()):
        licence = row.get("license", {})
        said.append(row.get("expression") or licence.get("id") or licence.get("name") or "")
    short = sorted({" ".join(text.split())[:60] for text in said if text})
    return ", ".join(short) or NOT_STATED


def write_materials(whole: dict[str, Any], out: Path) -> list[str]:
    """Write a bill per lock and the table of licences; return packages that state none."""
    used: dict[str, list[str]] = {}
    for lock in EXTRAS:
        said = part_of(whole, lock)
        text = json.dumps(said, indent=1, sort_keys=True) + "\n"
        (out / f"sbom-{lock}.cdx.json").write_text(text)
        for item in said["components"]:
            used.setdefault(item["name"], []).append(lock)
    rows, silent = ["package\tversion\tlicence\tlocks"], []
    for item in sorted(whole["components"], key=lambda each: each["name"].lower()):
        if item["name"] in used:
            stated = licences(item)
            locks = " ".join(used[item["name"]])
            rows.append(f"{item['name']}\t{item['version']}\t{stated}\t{locks}")
            silent += [item["name"]] if stated == NOT_STATED else []
    (out / "licences.tsv").write_text("\n".join(rows) + "\n")
    return silent
