"""A run of a simulated line, off, on, off, on: long to make, so made once."""

import fcntl

import numpy as np
import pytest

from aff_runtime.loop.messages import Bypass
from tests.doubles.recorded_run import RecordedRun, files

EFFECTS = [
    {
        "effect": "eccentric_roller",
        "location": "swrap_follower",
        "parameters": {"eccentricity_m": 1.5e-4, "angle_rad": 0.5},
    }
]

FULL, SMALL = "amp_limit_m_s: 0.03", "amp_limit_m_s: 0.0015"
"""So small that some ripple stays: a reduction that can be told from the noise."""


@pytest.fixture(scope="session")
def abab_run(tmp_path_factory, worker_id):
    """Off 25 s, on 37 s, twice; and the plant's true tension and angle."""
    own = tmp_path_factory.getbasetemp()
    folder = (own if worker_id == "master" else own.parent) / "abab"
    folder.mkdir(exist_ok=True)
    truth, name = folder / "truth.npy", folder / "name"
    with (folder / "lock").open("w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # of several workers one makes it
        if not name.exists():
            path, rows = made_in(folder)
            np.save(truth, rows)
            name.write_text(str(path), encoding="utf-8")
    return folder / name.read_text(encoding="utf-8"), np.load(truth)


def made_in(folder):
    """Return the run's folder, and time, true tension and true angle (ticks, 3)."""
    made = files(folder, EFFECTS, cancels="", cycle_ms=10)
    text = made.site.read_text()
    assert text.count(FULL) == 1
    made.site.write_text(text.replace(FULL, SMALL))
    run = RecordedRun(made, folder / "runs")
    truth = []
    run.bench.plant.observers.append(
        lambda plant: truth.append(
            (
                plant.time_s,
                plant.measured["true_pullroll_tension_N"],
                plant.measured["true_swrap_follower_angle_rad"],
            )
        )
    )
    run.bench.run(30.0)
    run.bench.arm(37.0)
    run.bench.say(Bypass())
    run.bench.run(26.0)
    run.bench.arm(37.0)
    return run.end(), np.array(truth)
