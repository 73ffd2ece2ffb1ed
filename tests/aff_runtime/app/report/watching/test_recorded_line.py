"""What the store takes from a line in virtual time, against what the plant has."""

import numpy as np
import pytest

from aff_runtime.app.report.watching.run_hours import run_hours
from aff_runtime.app.report.watching.store import Store
from tests.doubles.recorded_run import RecordedRun, files

pytestmark = pytest.mark.timeout(300)


def eccentric(size_m):
    return {
        "effect": "eccentric_roller",
        "location": "R6",
        "parameters": {"eccentricity_m": size_m, "angle_rad": 0.5},
    }


def watched(folder, size_m):
    """Return the store of a run of 27 s, AFF on with a block for R6."""
    run = RecordedRun(files(folder, [eccentric(size_m)]), folder / "runs", law_too=True)
    run.bench.run(1.0)
    run.bench.arm(26.0)
    store = Store()
    store.add(run_hours(run.end()))
    return store


def r6(store, column):
    chosen = (store.orders["roll"] == "r6") & (store.orders["signal"] == "unwind_tension_N")
    return float(store.orders[column][chosen][0])


def test_the_stroke_is_proportional_to_the_eccentricity_though_its_ripple_is_cancelled(tmp_path):
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    once, twice = watched(tmp_path / "one", 1e-4), watched(tmp_path / "two", 2e-4)
    assert r6(twice, "stroke_m") == pytest.approx(2.0 * r6(once, "stroke_m"), rel=0.03)
    assert 1e-4 < r6(once, "stroke_m") < 4e-4  # two spans, and a drive that follows 4 Hz in part
    assert r6(once, "ripple_N") < 0.1
    assert once.orders["correcting"].all()
    assert once.orders["is_roll"][once.orders["roll"] == "unwind"].all()
    assert not once.orders["is_roll"][once.orders["roll"] == "r6"].any()
    assert np.isnan(once.orders["stroke_m"][once.orders["roll"] == "unwind"]).all()
