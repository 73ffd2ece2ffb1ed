"""A run of a simulated line, off, on, off, on: long to make, so made once."""

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
def abab_run(tmp_path_factory):
    """Off 12 s, on 22 s, twice; and the plant's true tension and angle."""
    folder = tmp_path_factory.mktemp("run")
    made = files(folder, EFFECTS, cancels="")
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
    run.bench.run(14.0)
    run.bench.arm(22.0)
    run.bench.say(Bypass())
    run.bench.run(13.0)
    run.bench.arm(22.0)
    return run.end(), np.array(truth)
