"""What a wheel has beside its packages: who has it alone begins with a file of it."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest
import setuptools
from setuptools.command.build_py import build_py

from aff_runtime.config.loader import load_site
from releasing.commands import ROOT
from sim_plant.base import shipped

CONFIG = ROOT / "config"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the package folder that the build puts beside its modules into a wheel."""
    folder = tmp_path_factory.mktemp("build")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("AFF_RUNTIME_BUILD", "numpy")
        patch.setattr(setuptools, "setup", lambda **_: None)
        patch.setattr(build_py, "run", lambda _: None)  # the modules, which are not looked at here
        kind = runpy.run_path(str(ROOT / "setup.py"))["BuildWithConfig"]
        command = kind.__new__(kind)
        command.build_lib, command.editable_mode = str(folder), False
        command.run()
    return folder / "sim_plant"


@pytest.fixture
def packed(built: Path) -> Path:
    """Return the folder of site files, lines and maps."""
    return built / "config"


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


def test_the_gateway_block_and_the_header_of_plc_code_are_in_a_wheel(
    built: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = ROOT / "deploy" / "plc"
    names = {path.name for path in folder.iterdir()}
    assert {"AFF_GATEWAY.st", "AFF_GATEWAY.scl", "AFF_GATEWAY.L5X", "aff_plc.h"} <= names
    assert {path.name for path in (built / "plc_code").iterdir()} == names
    assert shipped.shipped_plc("aff_plc.h") == folder / "aff_plc.h"
    monkeypatch.setattr(shipped, "_PACKAGE", built)
    text = shipped.shipped_plc("AFF_GATEWAY.st").read_text(encoding="utf-8")
    assert text == (folder / "AFF_GATEWAY.st").read_text(encoding="utf-8")
