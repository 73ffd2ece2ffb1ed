"""Every pair of data/lines against its label, and with its effects taken out.

Minutes a run, so only when asked for: AFF_LINES=1 python -m pytest <this file>. As one table:
python -m benchmarks.pairs
"""

import os

import numpy as np
import pytest

from benchmarks.pairs import faults, labels, plan, verdict

RUNS = plan()

pytestmark = [
    pytest.mark.skipif(not os.environ.get("AFF_LINES"), reason="minutes a pair: set AFF_LINES=1"),
    pytest.mark.timeout(3600),
]


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """Return one folder for all runs: a verdict is made once."""
    return tmp_path_factory.mktemp("pairs")


@pytest.mark.parametrize("run", [r for r in RUNS if not r.without], ids=lambda r: r.name)
def test_the_verdict_is_the_label(run, out):
    assert faults(run, verdict(run, out)) == []


@pytest.mark.parametrize("case", list(labels()))
def test_the_error_on_the_held_out_record_is_the_floor(case, out):
    run = next(r for r in RUNS if r.case == case)
    errors = verdict(run, out).residual_rms.values()
    assert np.median([e.after / e.noise_floor for e in errors]) < 1.05


@pytest.mark.parametrize("run", [r for r in RUNS if r.without], ids=lambda r: r.name)
def test_without_its_effect_in_the_library_it_is_unknown_at_its_place(run, out):
    assert faults(run, verdict(run, out)) == []
