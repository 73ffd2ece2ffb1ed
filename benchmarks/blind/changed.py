"""A declared number that becomes another one at a moment: which, by how much, in the machine."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.blind.effects import Hidden, Rng
from benchmarks.blind.plant import DRAW, DRIVE, GAIN, LOOP, MODULUS, ZERO, Plant

CHANGED = "changed_number"
FOREVER_S = 1e9
NUMBERS: dict[str, tuple[float, int, float, float]] = {
    "web.EA_N": (MODULUS, 0, 0.01, 0.05),
    "control.pull_roll_draw": (DRAW, 3, 5e-5, 4e-4),
    "control.drives.pull_roll.K_ref_rad_s": (DRIVE, 3, 0.05, 0.3),
    "control.drives.unwind.K_ref_rad_s": (DRIVE, 0, 0.05, 0.3),
    "control.tension_pi.unwind.gain_m_s_per_N": (LOOP, 0, 0.05, 0.3),
    "sensors.r3_tension_N.gain": (GAIN, 2, 0.005, 0.03),
    "sensors.unwind_tension_N.offset": (ZERO, 0, 0.3, 1.5),
    "sensors.pullroll_tension_N.offset": (ZERO, 1, 0.3, 1.5),
}
"""By the path of a number: what of the machine it is, at which place, and between which sizes it
changes, either way: a share of it, of a draw the draw, of a zero N."""


def hide_changed(rng: Rng, path: str) -> Hidden:
    """Return a change of a number in the record that is fitted, half of the time in both."""
    _, _, low, high = NUMBERS[path]
    size = math.exp(rng.uniform(math.log(low), math.log(high))) * float(rng.choice([-1.0, 1.0]))
    records = "ab" if rng.random() < 0.5 else "a"
    moments = {name: round(float(rng.uniform(24.0, 54.0)), 2) for name in records}
    numbers = {"change": float(f"{size:.5g}"), "from_record_time_s": moments}
    return Hidden(effect=CHANGED, location=path, parameters=numbers)


def becomes(p: Plant, hidden: Hidden, record: str) -> Plant:
    """Return the machine with a number that changes, where it does in this record."""
    what, at, _, _ = NUMBERS[hidden.location]
    from_s = hidden.parameters["from_record_time_s"].get(record)
    if from_s is None:
        return p
    row = [what, at, hidden.parameters["change"], from_s, 0.0, FOREVER_S]
    return p._replace(change=np.concatenate([p.change, np.array([row], dtype=np.float64)]))
