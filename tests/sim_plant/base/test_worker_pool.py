"""A pool of worker processes: order, errors, who gets which job."""

import os
import signal

import pytest

from sim_plant.base.worker_pool import LostJobError, WorkerPool
from tests.sim_plant.base.pool_jobs import end_of, half, refuse, remember

pytestmark = pytest.mark.timeout(120)
LIMIT_S = 60.0


def test_results_come_in_the_order_of_the_jobs_from_workers_that_began_once():
    with WorkerPool(half, 2, limit_s=LIMIT_S, begin=remember, arguments=("begun",)) as pool:
        found = pool.map([8, 6, 4, 2, 0])
        more = pool.map([8, 6])
    assert [result for result, _, _ in found] == [4, 3, 2, 1, 0]
    assert len({pid for _, pid, _ in (*found, *more)} - {os.getpid()}) <= 2
    assert {begun for _, _, begun in (*found, *more)} == {("begun",)}


def test_no_jobs_are_no_results_and_no_process():
    with WorkerPool(half, 2, limit_s=LIMIT_S) as pool:
        assert pool.map([]) == []
        assert not pool._idle


def test_an_error_of_a_job_comes_back_with_where_it_was_raised():
    with WorkerPool(half, 2, limit_s=LIMIT_S) as pool:
        with pytest.raises(ValueError, match="three has no half") as caught:
            pool.map([2, 3])
        assert "in half" in caught.value.__notes__[0]
        with pytest.raises(RuntimeError, match="OddError: five: has no half either"):
            pool.map([5])
        assert [result for result, _, _ in pool.map([2, 4])] == [1, 2]


def test_jobs_are_taken_only_when_a_worker_is_free():
    taken = []

    def jobs():
        for number in (0, 2, 4, 6, 8):
            taken.append(number)
            yield number

    with WorkerPool(half, 2, limit_s=LIMIT_S) as pool:
        found = pool.run(jobs())
        next(found)
        assert len(taken) <= 3
        found.close()


def test_a_worker_that_was_killed_between_two_jobs_costs_nothing():
    said = []
    with WorkerPool(half, 1, limit_s=LIMIT_S, tell=said.append) as pool:
        ((_, first, _),) = pool.map([2])
        os.kill(first, signal.SIGKILL)
        pool._idle[0]._process.join()
        ((result, second, _),) = pool.map([4])
    assert (result, second != first, said) == (2, True, [])


def test_the_last_try_of_a_job_has_no_other_beside_it(tmp_path):
    (tmp_path / "at-work").mkdir()
    jobs = [(str(tmp_path), name, name == "bad") for name in ("one", "bad", *"abcdef")]
    with WorkerPool(end_of, 2, limit_s=LIMIT_S, name=lambda job: job[1]) as pool:
        found = dict(pool.run(jobs))
    lost = found.pop(1)
    assert isinstance(lost, LostJobError)
    assert str(lost).startswith("bad: 3 worker processes in turn were lost at it, the last one ")
    assert sorted(found.values()) == sorted(["one", *"abcdef"])
    tries = sorted(tmp_path.glob("bad *"), key=lambda path: path.stat().st_mtime_ns)
    assert len(tries) == 3
    assert tries[-1].read_text() == "bad"


def test_a_worker_that_cannot_begin_is_told_as_that():
    with (
        WorkerPool(half, 1, limit_s=LIMIT_S, begin=os._exit, arguments=(3,)) as pool,
        pytest.raises(LostJobError, match=r"^8: 3 worker .* the last one ended with exit code 3;"),
    ):
        pool.map([8])


def test_an_error_in_beginning_comes_back_at_once():
    with WorkerPool(half, 1, limit_s=LIMIT_S, begin=refuse) as pool:
        with pytest.raises(ValueError, match="nothing to begin with"):
            pool.map([8])
        assert not pool._busy
