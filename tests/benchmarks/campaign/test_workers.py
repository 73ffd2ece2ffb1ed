import signal

import pytest

from tests.orphans import PATIENCE_S, begun, descendants, left_by
from tests.processes import until

pytestmark = pytest.mark.processes

WORKERS = 2


def busy(parent, scratch):
    """Wait until a campaign has its workers, and they their first cases."""

    def at_work():
        assert parent.poll() is None
        return len(list(scratch.glob("work/*"))) >= WORKERS

    until("the workers have cases", at_work, PATIENCE_S)
    return descendants(parent.pid)


@pytest.mark.long
def test_workers_end_with_a_campaign_that_was_killed(tmp_path):
    parent = begun(
        [
            "-m",
            "benchmarks.campaign",
            "--seed",
            "1",
            "--cases",
            "2",
            "--workers",
            str(WORKERS),
            "--out",
            str(tmp_path),
        ]
    )
    workers = busy(parent, tmp_path)
    assert len(workers) >= 2 * WORKERS  # and each the process of its case
    assert not left_by(parent, workers, signal.SIGKILL)
