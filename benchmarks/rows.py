"""Results on disk, one JSON file each: written whole or not at all, read with a check."""

from __future__ import annotations

import json
import sys
from collections.abc import Collection
from pathlib import Path
from typing import Any

from aff_runtime.base.files import replace_text


def write_row(path: Path, row: Any) -> None:
    """Write ``row``; a stop in the middle or a full disk leaves what was there before.

    Raises
    ------
    OSError
        When it cannot be written.
    """
    replace_text(path, json.dumps(row, indent=1, default=float) + "\n")


def read_row(path: Path, keys: Collection[str]) -> dict[str, Any] | None:
    """Return a row that has these keys; None where there is none, or no whole one: it says so."""
    found = _read(path)
    if isinstance(found, dict) and found.keys() >= set(keys):
        return found
    if found is not None:
        _say(path, f"a table with {', '.join(sorted(keys))} was expected")
    return None


def read_rows(path: Path) -> list[dict[str, Any]]:
    """Return a file of several rows; empty where there is none, or no whole one: it says so."""
    found = _read(path)
    if isinstance(found, list) and all(isinstance(row, dict) for row in found):
        return found
    if found is not None:
        _say(path, "a list of tables was expected")
    return []


def _read(path: Path) -> Any:
    """Return what a file holds, None where there is none."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except (OSError, ValueError, RecursionError) as error:
        size = path.stat().st_size if path.exists() else 0
        _say(path, f"{size} bytes, {error}")
        return None
    if found is None:
        _say(path, "it holds null")
    return found


def _say(path: Path, why: str) -> None:
    sys.stderr.write(f"{path}: no whole row ({why}); it counts as not done, run it again\n")
