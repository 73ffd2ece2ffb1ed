"""The reference of the packages: a page each, with the modules that it offers to other rooms."""

from __future__ import annotations

import ast
from pathlib import Path

PACKAGES = ("aff_runtime", "sim_plant")
FOLDER = "code"
NOT_SEARCHED = "---\nsearch:\n  exclude: true\n---\n\n"
"""Words of code would stand before those of the pages."""


def offered(init: Path) -> list[str]:
    """Return the modules that a package names in ``__all__``."""
    for part in ast.parse(init.read_text(encoding="utf-8")).body:
        if isinstance(part, ast.Assign | ast.AnnAssign) and part.value is not None:
            goal = part.targets[0] if isinstance(part, ast.Assign) else part.target
            if isinstance(goal, ast.Name) and goal.id == "__all__":
                names = ast.literal_eval(part.value)
                return [name for name in names if (init.parent / f"{name}.py").exists()]
    return []


def reference_pages(root: Path) -> dict[str, str]:
    """Return the pages of the reference: path among the site's sources, Markdown."""
    pages: dict[str, str] = {}
    rows = ["# Code", "", "Packages, and of each the modules that other rooms may use.", ""]
    rows += ["| package | what |", "|---|---|"]
    for package in PACKAGES:
        for init in sorted((root / package).rglob("__init__.py")):
            modules = offered(init)
            if not modules:
                continue
            name = ".".join(init.parent.relative_to(root).parts)
            said = ast.get_docstring(ast.parse(init.read_text(encoding="utf-8"))) or ""
            first = said.partition("\n")[0]
            rows.append(f"| [`{name}`]({name}.md) | {first} |")
            body = "\n\n".join(f"::: {name}.{module}" for module in modules)
            pages[f"{FOLDER}/{name}.md"] = f"{NOT_SEARCHED}# `{name}`\n\n{first}\n\n{body}\n"
    pages[f"{FOLDER}/index.md"] = "\n".join(rows) + "\n"
    return pages
