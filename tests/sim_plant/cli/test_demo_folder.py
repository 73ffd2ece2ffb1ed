"""What the demo does to the folder it is given."""

from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.demo.session import Plan, prepare

ROOT = Path(__file__).parents[3]


def test_a_folder_with_other_files_is_left_alone(tmp_path: Path) -> None:
    kept = tmp_path / "thesis.txt"
    kept.write_text("mine")
    plan = Plan(
        line=ROOT / "config/lines/euclid_ripple.yaml",
        site=ROOT / "config/euclid.yaml",
        out=tmp_path,
        line_speed_m_s=1.0,
    )
    with pytest.raises(PlantError, match="holds other files"):
        prepare(plan)
    assert kept.read_text() == "mine"
