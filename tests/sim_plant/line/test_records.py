"""A record of another simulator of the same line, reproduced from its declaration alone.

The records come from other equations, other code and another integrator. The model runs without
noise, on the declared numbers; what is left is the noise of the record, labelled per channel.

Judged from 20 s on: no record declares its start state, and the pull-roll zone forgets it slowly.
Angles are judged without their mean: they integrate speed, so what an undeclared start state does
to the speed in the first seconds stays in them as a constant for ever.
"""

import gzip
import re

import numpy as np

from sim_plant.line.open import make_line
from sim_plant.line.reading.load import load_declaration
from tests import quick_yaml

ALLOWED = 1.2
FROM_ROW = 2000
RADIUS_STEP_M = 1e-5  # declarations give roll radii with five decimals


def replayed(folder, name):
    """Record minus model from 20 s on, model and noise floor per channel."""
    line = load_declaration(folder / f"{name}.yaml")
    with gzip.open(folder / f"{name}.csv.gz", "rt") as stream:
        names = stream.readline().strip().split(",")
        rows = dict(zip(names, np.loadtxt(stream, delimiter=",").T, strict=True))
    speed, tension = rows["line_speed_ref_m_s"], rows["tension_ref_N"]
    model = make_line(line, seed=None, speed_m_s=float(speed[0]), tension_N=float(tension[0]))
    model.settle(4.0)
    found = model.simulate(speed, tension, {})
    labels = quick_yaml.safe_load((folder / "labels.yaml").read_text())
    case, part = re.fullmatch(r"(line\d+)_(\w)", name).groups()
    record = next(c for c in labels["cases"] if c["case"] == case)["records"][part]
    floors = record["noise_floor_rms"]
    residual = {c: (rows[c] - found[c])[FROM_ROW:] for c in floors}
    return line, residual, {c: found[c][FROM_ROW:] for c in floors}, floors


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def ratios(residual, floors):
    """Residual over noise floor, angles without their mean."""
    centred = {c: r - r.mean() if c.endswith("_angle_rad") else r for c, r in residual.items()}
    return {c: rms(centred[c]) / floors[c] for c in floors}


def test_healthy_record_is_reproduced_to_its_noise_in_every_channel(line_records):
    _line, residual, _model, floors = replayed(line_records, "line01_a")
    assert len(floors) == 12
    found = ratios(residual, floors)
    assert {c: r for c, r in found.items() if r > ALLOWED} == {}


def test_held_out_record_is_reproduced_to_its_noise_in_every_other_channel(line_records):
    """line01_b, another radius and other speeds: all channels but the unwind angle.

    An angle is a random walk under the record's own noise; the label gives a perfect model 1.18
    times the floor on the follower's angle, so 1.3 is asked there.
    """
    _line, residual, _model, floors = replayed(line_records, "line01_b")
    found = ratios(residual, floors)
    del found["unwind_angle_rad"]
    assert found.pop("swrap_follower_angle_rad") < 1.3
    assert len(found) == 10
    assert {c: r for c, r in found.items() if r > ALLOWED} == {}


def test_held_out_unwind_angle_drifts_by_less_than_its_radius_is_declared(line_records):
    """line01_b turns 1.3e-5 slower than its declaration: its roll is 1.7 um larger.

    That lies within the last decimal of the declared radius (10 um), which no model can know:
    the drift is proportional to the angle, and without it the noise is all that is left.
    """
    line, residual, model, floors = replayed(line_records, "line01_b")
    angle = model["unwind_angle_rad"]
    slope, offset = np.polyfit(angle, residual["unwind_angle_rad"], 1)
    assert abs(slope) * line.initial_radii_m.unwind < 0.5 * RADIUS_STEP_M
    left = rms(residual["unwind_angle_rad"] - offset - slope * angle)
    assert left < ALLOWED * floors["unwind_angle_rad"]
    assert ratios(residual, floors)["unwind_angle_rad"] > ALLOWED  # reported, not hidden


def test_a_line_with_an_effect_is_not_reproduced(line_records):
    """The same comparison sees an effect: line02 does not pass as healthy."""
    _line, residual, _model, floors = replayed(line_records, "line02_a")
    assert max(ratios(residual, floors).values()) > 1.5
