"""What a wheel has beside its packages: who has it alone begins with a file of it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from aff_runtime.config.loader import load_site
from releasing.commands import ROOT

CONFIG = ROOT / "config"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return `sim_plant/config` of what a wheel is packed from."""
    folder = tmp_path_factory.mktemp("built")
    command = [sys.executable, "setup.py", "--quiet", "build_py", "--build-lib", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    return folder / "sim_plant" / "config"


def test_every_shipped_site_file_is_whole_in_a_wheel_with_the_files_that_it_names(
    built: Path,
) -> None:
    names = sorted(path.name for path in CONFIG.glob("*.yaml"))
    assert "euclid_can.yaml" in names
    assert sorted(path.name for path in built.glob("*.yaml")) == names
    for name in names:
        assert load_site(built / name) == load_site(CONFIG / name)


@pytest.mark.parametrize("folder", ["lines", "plc"])
def test_lines_and_plc_maps_are_in_a_wheel(built: Path, folder: str) -> None:
    files = {path.name: path.read_bytes() for path in (CONFIG / folder).glob("*.yaml")}
    assert files
    assert {path.name: path.read_bytes() for path in (built / folder).iterdir()} == files
