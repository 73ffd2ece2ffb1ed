"""From a refinement's AFF block, pasted into the site file, to a quiet web two turns after arm."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.config.loader import load_site
from aff_runtime.loop.messages import Arm
from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.report.aff_block import write_block
from tests import quick_yaml
from tests.lockstep.known_response import ROOT
from tests.lockstep.test_shape_law import SITE, TURN_S, ripple, shop
from tests.sim_plant.refine.small import finding

pytestmark = pytest.mark.timeout(300)
LINE = ROOT / "config" / "lines" / "euclid.yaml"  # nominal: it does not know the roll
FLAT = {"shape": "flat", "size_m": 0.0118, "angle_rad": 0.7}  # the roll has 12 mm


def pasted(folder: Path, **changes: Any) -> Path:
    """Write a site file whose unwind block is the one of a refinement; return its path."""
    found = finding("out_of_round_roll", "unwind", {**FLAT, **changes})
    written = write_block(folder, [found], load_declaration(LINE))
    assert written is not None
    (block,) = quick_yaml.safe_load(written.read_text())["blocks"]
    text = SITE.read_text()
    found = re.search(r"      - roll: unwind\n(?:        .*\n)+", text)
    assert found is not None
    ours = quick_yaml.safe_dump([block], sort_keys=False, default_flow_style=None)
    indented = "".join(f"      {line}\n" for line in ours.splitlines())
    path = folder / "euclid.yaml"
    path.write_text(text.replace(found.group(), indented))
    return path


def test_the_block_is_a_valid_part_of_the_site_file(tmp_path):
    block = load_site(pasted(tmp_path)).actuators["unwind"].blocks[0]
    assert block.orders[0] == 1
    assert len(block.start) >= 12
    assert 0.5e-3 < block.start[0].deviation_m < 1.5e-3


@pytest.mark.long  # quick: a kept shape, test_shape_law.py; the block, above
def test_a_refinements_shape_quiets_the_web_two_turns_after_arming(responses, tmp_path):
    made = shop(responses, site_file=pasted(tmp_path))
    made.bench.run(6.0)
    made.rows.clear()
    made.bench.run(4.0)
    _, _, before_N = ripple(made.rows)
    assert any("unwind: starts from the start shape" in text for text in made.said), made.said
    made.bench.say(Arm())
    made.bench.run(1.5 + 2.0 * TURN_S)
    made.rows.clear()
    made.bench.run(2.0 * TURN_S)
    assert ripple(made.rows)[2] <= 0.15 * before_N


@pytest.mark.long  # quick: a saved shape, test_shape_law.py
def test_a_refinement_that_was_wrong_about_the_roll_is_not_used(responses, tmp_path):
    made = shop(responses, site_file=pasted(tmp_path, shape="ellipse", size_m=0.002))
    made.bench.run(9.0)
    assert any("not used" in text for text in made.said), made.said
    assert not any(made.bench.law.shape_laws()["unwind"].weights().values())
