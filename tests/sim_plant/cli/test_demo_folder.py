"""What the demo does to the folder it is given."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.demo.processes import Child
from sim_plant.demo.session import DemoPlan, prepare
from tests.processes import is_running

ROOT = Path(__file__).parents[3]


def test_a_folder_with_other_files_is_left_alone(tmp_path: Path) -> None:
    kept = tmp_path / "thesis.txt"
    kept.write_text("mine")
    plan = DemoPlan(
        line=ROOT / "config/lines/euclid_ripple.yaml",
        site=ROOT / "config/euclid.yaml",
        out=tmp_path,
        line_speed_m_s=1.0,
    )
    with pytest.raises(PlantError, match="holds other files"):
        prepare(plan)
    assert kept.read_text() == "mine"


def test_a_folder_of_a_start_that_failed_is_taken_again(tmp_path: Path) -> None:
    (tmp_path / "plant.log").write_text("the plant did not become ready")
    plan = DemoPlan(
        line=ROOT / "config/lines/euclid_ripple.yaml",
        site=ROOT / "config/euclid.yaml",
        out=tmp_path,
        line_speed_m_s=1.0,
    )
    assert prepare(plan).folder == tmp_path
    assert not (tmp_path / "plant.log").exists()


def test_a_process_that_does_not_become_ready_is_not_left_behind(tmp_path: Path) -> None:
    pid = tmp_path / "pid"
    script = f"import os, time; open({str(pid)!r}, 'w').write(str(os.getpid())); time.sleep(60)"
    command = [sys.executable, "-S", "-c", script]
    with pytest.raises(PlantError, match="did not become ready"):
        Child("plant", command, tmp_path / "log", "ready", patience_s=5.0)
    assert not pid.exists() or not is_running(int(pid.read_text()))
