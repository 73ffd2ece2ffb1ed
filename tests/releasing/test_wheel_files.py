"""What a wheel has beside its packages: who has it alone begins with a file of it."""

from __future__ import annotations

import ast
import shutil
from pathlib import Path

import pytest

from aff_runtime.config.loader import load_site
from releasing.commands import ROOT

CONFIG = ROOT / "config"


def patterns() -> tuple[str, ...]:
    """Return which files of `config` the build puts into a wheel."""
    for part in ast.parse((ROOT / "setup.py").read_text(encoding="utf-8")).body:
        if isinstance(part, ast.Assign) and ast.unparse(part.targets[0]) == "SHIPPED":
            return tuple(ast.literal_eval(part.value))
    raise AssertionError("setup.py names no SHIPPED")


@pytest.fixture(scope="module")
def packed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with these files alone."""
    folder = tmp_path_factory.mktemp("config")
    for pattern in patterns():
        for source in CONFIG.glob(pattern):
            target = folder / source.relative_to(CONFIG)
            target.parent.mkdir(exist_ok=True)
            shutil.copyfile(source, target)
    return folder


def test_every_shipped_site_file_loads_from_what_a_wheel_has(packed: Path) -> None:
    names = sorted(path.name for path in CONFIG.glob("*.yaml"))
    assert "euclid_can.yaml" in names
    for name in names:
        assert load_site(packed / name) == load_site(CONFIG / name)


@pytest.mark.parametrize("folder", ["lines", "plc"])
def test_every_line_and_plc_map_is_in_a_wheel(packed: Path, folder: str) -> None:
    names = {path.name for path in (CONFIG / folder).glob("*.yaml")}
    assert names
    assert {path.name for path in (packed / folder).iterdir()} == names
