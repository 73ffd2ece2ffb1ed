"""Our end of a worker's pipe, with the other end played by the test."""

import multiprocessing
import os

import pytest

from aff_runtime.base.clock import MonotonicClock
from sim_plant.base.worker_pipe import WorkerPipe, wait
from sim_plant.base.worker_pool import WorkerPool

CLOCK = MonotonicClock()
pytestmark = pytest.mark.timeout(60)  # who waits in vain here waits an hour
LONG_S = 3600.0


@pytest.fixture
def ends():
    near, far = multiprocessing.Pipe()
    with near, far:
        yield WorkerPipe(near), far


def test_an_answer_heard_while_the_job_was_sent_is_not_waited_for(ends):
    pipe, far = ends
    far.send_bytes(b"answer")
    pipe.send(b"job")  # takes the answer with it
    wait([pipe], LONG_S)
    assert pipe.message() == b"answer"
    assert pipe.message() is None


def test_an_end_heard_while_the_job_was_sent_is_not_waited_for(ends):
    pipe, far = ends
    far.close()
    pipe.send(b"job")
    assert pipe.has_ended
    wait([pipe], LONG_S)


def test_half_an_answer_is_waited_for(ends):
    pipe, far = ends
    os.write(far.fileno(), (6).to_bytes(4, "big") + b"ans")
    pipe.exchange()
    assert not pipe.has_message
    wait([pipe], 0.01)
    assert pipe.message() is None
    os.write(far.fileno(), b"wer")
    wait([pipe], LONG_S)
    pipe.exchange()
    assert pipe.message() == b"answer"


def test_a_pool_goes_on_where_a_worker_answers_before_its_job_is_sent_off(monkeypatch):
    """As on a busy machine, that lets the worker go first between our write and our read."""
    own_exchange = WorkerPipe.exchange

    def late_exchange(pipe):
        own_exchange(pipe)
        deadline_ns = CLOCK.now_ns() + 300_000_000
        while not pipe.has_message and CLOCK.now_ns() < deadline_ns:
            own_exchange(pipe)

    with WorkerPool(abs, 1, limit_s=LONG_S) as pool:
        assert pool.map([-1]) == [1]  # the worker is ready
        monkeypatch.setattr(WorkerPipe, "exchange", late_exchange)
        assert pool.map([-2, -3]) == [2, 3]
