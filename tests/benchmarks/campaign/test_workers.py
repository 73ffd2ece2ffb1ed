import signal

from tests.orphans import outlived

KEEPER = """
import os, time
from benchmarks.campaign.__main__ import pool_of
if __name__ == "__main__":
    with pool_of(2) as pool:
        jobs = [pool.submit(os.getpid) for _ in range(8)]
        print(*sorted({job.result() for job in jobs}), flush=True)
        time.sleep(600)
"""


def test_workers_end_with_a_campaign_that_was_killed(tmp_path):
    (tmp_path / "keeper.py").write_text(KEEPER)
    assert not outlived(tmp_path / "keeper.py", signal.SIGKILL)
