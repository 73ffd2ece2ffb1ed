"""axe-core on a page of ours: rules of WCAG that a program can check."""

from __future__ import annotations

from importlib import resources
from typing import Any

import pytest

GRAVE = ("serious", "critical")


def source() -> str:
    """Return axe-core as the package axe-playwright-python brings it; without it, skip."""
    pytest.importorskip("axe_playwright_python", reason="axe-playwright-python is not installed")
    return (resources.files("axe_playwright_python") / "axe.min.js").read_text(encoding="utf-8")


def grave_findings(page: Any) -> list[str]:
    """Return what axe calls serious or critical, with its place, of a Playwright page."""
    if not page.evaluate("() => 'axe' in window"):
        page.evaluate(source())
    found = page.evaluate("() => axe.run(document, {resultTypes: ['violations']})")
    assert len(found["passes"]) > 10  # it has looked
    return [
        f"{one['id']} at {node['target']}: {node['failureSummary']}"
        for one in found["violations"]
        if one["impact"] in GRAVE
        for node in one["nodes"]
    ]
