"""A run off, on, off, on: by a formula, and of a simulated line, which takes long to make."""

from pathlib import Path

import numpy as np
import pytest

from aff_runtime.loop.messages import Bypass
from tests import quick_yaml
from tests.aff_runtime.app.card.measure.recorded import SMALL_M, recorded, switched
from tests.doubles.recorded_run import FOLLOWER, RecordedRun, files
from tests.made_once import made_once

FULL, SMALL = "amp_limit_m_s: 0.03", "amp_limit_m_s: 0.0015"
"""So small that some ripple stays: a reduction that can be told from the noise."""
SPAN_OF_SMALL_M = 1.20193
"""From a roll of that radius to R1, whose centres stand where they stood."""


@pytest.fixture(
    scope="session", params=["by formula", pytest.param("simulated", marks=pytest.mark.long)]
)
def abab_run(request, tmp_path_factory, worker_id):
    """Off 30 s, on 37 s, off 26 s, on 37 s; and the true tension and angle."""
    make = made_in if request.param == "simulated" else by_formula

    def keep(folder):
        path, rows = make(folder)
        np.save(folder / "truth.npy", rows)
        (folder / "name").write_text(str(path), encoding="utf-8")

    folder = made_once(tmp_path_factory, worker_id, f"abab {request.param}", keep)
    path = (folder / "name").read_text(encoding="utf-8")
    return Path(path), np.load(folder / "truth.npy")


def by_formula(folder):
    """Return the same of a record that is made up, with an on between that a fault cut short."""
    columns, truth = switched(161.0, [(29.0, 64.0), (87.0, 103.0), (126.0, 161.0)])
    return recorded(folder / "runs", columns), truth


def made_in(folder):
    """Return the run's folder, and time, true tension and true angle (ticks, 3)."""
    made = files(folder, [FOLLOWER], cancels="", cycle_ms=10)
    text = made.site.read_text()
    assert text.count(FULL) == 1
    made.site.write_text(text.replace(FULL, SMALL))
    line = quick_yaml.safe_load(made.line.read_text())
    line["initial_radii_m"]["unwind"] = line["rollers"][0]["radius_m"] = SMALL_M
    line["spans"][0]["length_m"] = SPAN_OF_SMALL_M
    made.line.write_text(quick_yaml.safe_dump(line, sort_keys=False))
    run = RecordedRun(made, folder / "runs")
    truth = run.truth()
    run.bench.run(30.0)
    run.bench.arm(37.0)
    run.bench.say(Bypass())
    run.bench.run(26.0)
    run.bench.arm(37.0)
    return run.end(), np.array(truth)
