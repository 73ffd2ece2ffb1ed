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


@pytest.mark.parametrize("page", ["overview", "login"])
def test_a_page_without_the_words_of_the_see_pages_has_not_their_script(page):
    """It reads them as it is loaded: where they are not, nothing after it would run."""
    assert "// see.js\n" not in served(has_hand=True)[f"{page}.js"][0].decode()
