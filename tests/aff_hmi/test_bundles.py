"""What is joined for a page is a script that a browser reads."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from aff_hmi.bundles import PAGES, joined, served, source


@pytest.mark.skipif(shutil.which("node") is None, reason="node is needed")
@pytest.mark.parametrize("page", PAGES)
def test_every_joined_script_can_be_read(tmp_path: Path, page: str) -> None:
    text, _ = served(has_hand=True)[f"{page}.js"]
    script = tmp_path / f"{page}.mjs"
    script.write_bytes(text)
    done = subprocess.run(
        ["node", "--check", str(script)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_what_is_imported_by_another_name_has_it() -> None:
    assert 'import { short as shortly } from "/static/curves.js"' in source("commission.js")
    assert "const { short: shortly } = of_curves;" in joined(("commission.js",))
