"""Processes of this bench: its package is not installed, so they are told where it is."""

from __future__ import annotations

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def environment() -> dict[str, str]:
    """Return our environment with the repository's root on the module path."""
    known = os.environ.get("PYTHONPATH")
    path = str(ROOT) if not known else f"{ROOT}{os.pathsep}{known}"
    return {**os.environ, "PYTHONPATH": path}
