import signal
import time

from tests.orphans import PATIENCE_S, begun, children, left_by

WORKERS = 2


def busy(parent, scratch):
    """Wait until a campaign has its workers, and they their first cases."""
    end = time.monotonic() + PATIENCE_S
    while len(list(scratch.glob("work/*"))) < WORKERS and time.monotonic() < end:
        assert parent.poll() is None
        time.sleep(0.05)
    return children(parent.pid)


def test_workers_end_with_a_campaign_that_was_killed(tmp_path):
    parent = begun(["-m", "benchmarks.campaign", "--seed", "1", "--cases", "2",
                    "--workers", str(WORKERS), "--out", str(tmp_path)])  # fmt: skip
    workers = busy(parent, tmp_path)
    assert len(workers) >= WORKERS
    assert not left_by(parent, workers, signal.SIGKILL)
