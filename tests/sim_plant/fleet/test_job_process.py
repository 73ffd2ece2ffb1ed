"""A job has a process of its own, which ends with its caller and with its time."""

import signal
import time
from pathlib import Path

import pytest

from sim_plant.fleet.job_process import DONE, ENDED, RAISED, in_own_process, orders
from tests.orphans import begun, left_by
from tests.sim_plant.fleet import jobs

pytestmark = pytest.mark.processes
LONG_S = 60.0


def is_running(pid):
    try:
        state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8")
    except FileNotFoundError:
        return False
    return state.rpartition(")")[2].split()[0] != "Z"


def ends(pid):
    """Wait for a process to end; the test's own limit is the bound."""
    while is_running(pid):
        time.sleep(0.02)
    return True


def test_a_result_comes_back_and_prints_do_not_come_between():
    assert in_own_process(orders(jobs.half, 3), LONG_S) == (DONE, 1.5)


def test_what_a_job_raises_comes_back_with_where():
    kind, error = in_own_process(orders(jobs.half, -1), LONG_S)
    assert (kind, str(error)) == (RAISED, "no half of -1")
    assert "in half" in "".join(error.__notes__)


def test_a_process_that_is_killed_says_so(tmp_path):
    assert in_own_process(orders(jobs.killed_at_first, tmp_path), LONG_S) == (
        ENDED,
        "ended by signal 9",
    )


def test_a_job_that_takes_too_long_ends_with_all_that_it_started(tmp_path):
    note = tmp_path / "pid"
    assert in_own_process(orders(jobs.long_and_not_alone, note), 3.0) == (
        ENDED,
        "took longer than 3 s",
    )
    assert ends(int(note.read_text(encoding="utf-8")))


def test_a_job_ends_when_its_caller_is_killed(tmp_path):
    note = tmp_path / "pid"
    code = (
        "from sim_plant.fleet.job_process import in_own_process, orders\n"
        "from tests.sim_plant.fleet import jobs\n"
        f"in_own_process(orders(jobs.long_and_not_alone, {str(note)!r}), 600.0)\n"
    )
    caller = begun(["-c", code])
    while not (note.exists() and note.read_text(encoding="utf-8")):
        assert caller.poll() is None
        time.sleep(0.02)
    assert not left_by(caller, [int(note.read_text(encoding="utf-8"))], signal.SIGKILL)
