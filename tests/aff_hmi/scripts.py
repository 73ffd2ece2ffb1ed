"""One script of the screen in node, without a browser: what its functions return."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

STATIC = Path(__file__).parents[2] / "aff_hmi" / "static"


def called(
    folder: Path,
    name: str,
    expression: str,
    *given: Any,
    page: str = "",
    before: str = "",
    instead: Mapping[str, str] | None = None,
) -> Any:
    """Return what an expression is, with a script's exports as ``of`` and ``given``.

    Parameters
    ----------
    folder : an empty one. ``name`` : the script. ``instead`` : text of each that it imports.
    page : statements ahead of the script: what it finds in a browser.
    before : statements ahead of the expression.
    """
    put_script(folder, name, instead or {})
    main = (
        f'import "./page.mjs";\nimport * as of from "./{name}.mjs";\n'
        'import { readFileSync } from "node:fs";\n'
        f'const given = JSON.parse(readFileSync(0, "utf8"));\n{before}\n'
        f"console.log(JSON.stringify({expression}));\n"
    )
    (folder / "page.mjs").write_text(page, encoding="utf-8")
    return played(folder, main, given)


def put_script(folder: Path, name: str, instead: Mapping[str, str]) -> None:
    """Put a script into a folder as a module; ``instead`` : text of each that it imports."""
    script = (STATIC / f"{name}.js").read_text(encoding="utf-8")
    for other, text in instead.items():
        assert f'"/static/{other}.js"' in script
        script = script.replace(f'"/static/{other}.js"', f'"./{other}.mjs"')
        (folder / f"{other}.mjs").write_text(text, encoding="utf-8")
    (folder / f"{name}.mjs").write_text(script, encoding="utf-8")


def played(folder: Path, main: str, given: Any) -> Any:
    """Return what a program says that is given JSON, in a folder with its modules."""
    if shutil.which("node") is None:
        pytest.skip("node is needed")
    (folder / "main.mjs").write_text(main, encoding="utf-8")
    said = subprocess.run(
        ["node", "main.mjs"],
        cwd=folder,
        input=json.dumps(given),
        capture_output=True,
        text=True,
        check=False,
    )
    assert said.returncode == 0, said.stderr
    return json.loads(said.stdout)
