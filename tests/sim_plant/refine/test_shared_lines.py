"""Every pair of shared/data/lines against its label; minutes a pair, so only when asked for.

AFF_LINES=1 python -m pytest tests/sim_plant/refine/test_shared_lines.py
"""

import json
import os
from pathlib import Path

import numpy as np
import pytest
import yaml

from sim_plant.cli.main import main

PLACES = [Path(__file__).parents[n] / "shared/data/lines" for n in (4, 5)]
FOLDER = next((p for p in PLACES if p.exists()), None)
CASES = []
if FOLDER is not None:
    CASES = [c["case"] for c in yaml.safe_load((FOLDER / "labels.yaml").read_text())["cases"]]

pytestmark = [
    pytest.mark.skipif(FOLDER is None, reason="line records are not here (shared/data/lines)"),
    pytest.mark.skipif(not os.environ.get("AFF_LINES"), reason="minutes a pair: set AFF_LINES=1"),
    pytest.mark.timeout(1800),
]


def refined(case, out, *more):
    line, fit, held = (str(FOLDER / f"{case}_{end}") for end in ("a.yaml", "a.csv.gz", "b.csv.gz"))
    assert main(["refine", line, fit, "--holdout", held, "--out", str(out), *more]) == 0
    return json.loads((out / "verdict.json").read_text())


def label(case):
    cases = yaml.safe_load((FOLDER / "labels.yaml").read_text())["cases"]
    effects = next(c for c in cases if c["case"] == case)["effects"]
    return {(e["effect_class"], e["location"]) for e in effects}


@pytest.mark.parametrize("case", CASES)
def test_the_verdict_is_the_label_and_the_error_is_the_floor(case, tmp_path):
    result = refined(case, tmp_path)
    assert {(e["effect"], e["location"]) for e in result["effects"]} == label(case)
    assert result["verdict"] == ("traced" if label(case) else "nothing")
    ratio = [r["after"] / r["noise_floor"] for r in result["residual_rms"].values()]
    assert np.median(ratio) < 1.05


@pytest.mark.parametrize("case", [c for c in CASES if c != "line01"])
def test_without_its_effect_in_the_library_it_is_unknown(case, tmp_path):
    names = sorted({name for name, _ in label(case)})
    result = refined(case, tmp_path, *(part for n in names for part in ("--without", n)))
    assert result["verdict"] == "unknown"
    assert result["effects"] == []
