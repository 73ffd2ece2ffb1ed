"""Records of another simulator with a hidden effect: the labelled effect explains them.

Sizes are the labels'; start angles, which no label gives, were fitted once. Roll angles are
left out: they integrate what the declared radius does not tell (see line/test_records.py).
"""

import gzip

import numpy as np
import pytest

from sim_plant.line.open import make_line
from sim_plant.line.reading.load import load_declaration
from tests import quick_yaml
from tests.sim_plant.effects.running import effect
from tests.sim_plant.line.conftest import line_records  # noqa: F401 - a fixture

BOUNCE = {"mass_kg": 20.0, "frequency_Hz": 3.4, "damping": 0.06, "order": 4.0}
CASES = {
    "line04_a": effect("eccentric_roller", "R6", eccentricity_m=2e-4, angle_rad=np.radians(193.0)),
    "line05_a": effect("web_modulus", "web", factor=0.85),
    "line05_b": effect("web_modulus", "web", factor=0.85),
    "line06_a": effect("load_cell_filter", "all", corner_Hz=3.0),
    "line06_b": effect("load_cell_filter", "all", corner_Hz=3.0),
    "line08_a": effect(
        "roll_bounce",
        "unwind",
        cos1_kg_m=-0.0222,
        sin1_kg_m=-0.0200,
        cosn_kg_m=0.0284,
        sinn_kg_m=-0.0133,
        **BOUNCE,
    ),
    "line08_b": effect(
        "roll_bounce",
        "unwind",
        cos1_kg_m=0.0049,
        sin1_kg_m=0.0295,
        cosn_kg_m=-0.0163,
        sinn_kg_m=0.0258,
        **BOUNCE,
    ),
}


def worst_ratio(folder, name, effects):  # type: ignore[no-untyped-def]
    """Return the largest residual over noise floor among tensions and speeds, from 20 s on."""
    declared = load_declaration(folder / f"{name}.yaml").model_copy(update={"effects": effects})
    with gzip.open(folder / f"{name}.csv.gz", "rt") as stream:
        names = stream.readline().strip().split(",")
        rows = dict(zip(names, np.loadtxt(stream, delimiter=",").T, strict=True))
    speed, tension = rows["line_speed_ref_m_s"], rows["tension_ref_N"]
    model = make_line(declared, seed=None, speed_m_s=speed[0], tension_N=tension[0])
    model.settle(10.0)
    found = model.simulate(speed, tension)
    cases = quick_yaml.safe_load((folder / "labels.yaml").read_text())["cases"]
    records = next(c for c in cases if c["case"] == name[:6])["records"]
    floors = records[name[-1]]["noise_floor_rms"]
    return max(
        float(np.sqrt(np.mean((rows[c] - found[c])[2000:] ** 2))) / floors[c]
        for c in floors
        if "tension" in c or "speed" in c
    )


@pytest.mark.parametrize("name", CASES)
@pytest.mark.sweep(every=8)
def test_the_labelled_effect_leaves_the_noise_of_the_record(name, line_records) -> None:  # type: ignore[no-untyped-def]  # noqa: F811
    folder = line_records
    assert worst_ratio(folder, name, ()) > 2.0
    assert worst_ratio(folder, name, (CASES[name],)) < 1.07
