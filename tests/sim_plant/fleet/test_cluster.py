"""A real Dask cluster gives the work out: a killed worker or process costs a repeat."""

import json
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from sim_plant.base.worker_pool import LostJobError
from sim_plant.fleet.cluster import Cluster, ClusterError
from tests.sim_plant.fleet import jobs

pytestmark = pytest.mark.processes
LONG_S = 60.0


def text_in(path):
    """Wait for a file with text."""
    while not (path.exists() and path.read_text(encoding="utf-8")):
        time.sleep(0.02)
    return path.read_text(encoding="utf-8")


@pytest.mark.long  # quick: numbers and answers, below
def test_results_come_with_their_numbers_and_jobs_are_taken_when_there_is_room():
    taken = []

    def given():
        for number in range(5):
            taken.append(number)
            yield number

    with Cluster(jobs.half, 1, limit_s=LONG_S) as cluster:
        running = cluster.run(given())
        assert next(running) == (0, 0.0)
        assert taken == [0]
        assert sorted(running) == [(1, 0.5), (2, 1.0), (3, 1.5), (4, 2.0)]
        with pytest.raises(ValueError, match="no half of -1"):
            list(cluster.run([-1]))


@pytest.fixture
def at_hand():
    """A scheduler with one worker, both in this process."""
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
    ) as made:
        yield made


def test_a_killed_process_is_done_again_and_one_that_never_answers_is_told(at_hand, tmp_path):
    said = []
    with Cluster(
        jobs.killed_at_first,
        0,
        scheduler=at_hand.scheduler_address,
        limit_s=LONG_S,
        name=lambda _: "the job",
        tell=said.append,
    ) as cluster:
        assert list(cluster.run([tmp_path])) == [(0, 1)]
    assert said == ["the job: its process ended by signal 9; it is done again"]
    with Cluster(
        jobs.long_and_not_alone,
        0,
        scheduler=at_hand.scheduler_address,
        limit_s=0.1,
        name=lambda _: "it",
    ) as cluster:
        ((number, lost),) = cluster.run([tmp_path / "pid"])
    assert (number, type(lost)) == (0, LostJobError)
    assert "it: every try was lost, its last process took longer than 0.1 s" in str(lost)


@pytest.mark.long  # quick: on a cluster of ours, above
def test_a_killed_worker_of_a_cluster_started_by_hand_loses_nothing(tmp_path):
    address = tmp_path / "scheduler.json"
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1"]
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--nthreads", "1"]
    rest = ["--no-dashboard", "--scheduler-file", str(address)]
    started = [subprocess.Popen([*dask, "--port", "0", *rest], stderr=subprocess.DEVNULL)]
    try:
        text_in(address)
        for _ in range(2):
            command = [*worker, "--no-nanny", *rest]
            started.append(subprocess.Popen(command, stderr=subprocess.DEVNULL))
        from distributed import Client

        with Client(scheduler_file=str(address)) as client:
            client.wait_for_workers(2)
            scheduler = client.scheduler.address
        note, wanted = tmp_path / "who", tmp_path / "wanted"
        with Cluster(jobs.waiting_for, 0, scheduler=scheduler, limit_s=LONG_S) as cluster:
            running = cluster.run([(note, wanted)])

            def kill_then_give():
                os.kill(int(text_in(note).split()[0]), signal.SIGKILL)
                wanted.write_text("the answer", encoding="utf-8")

            killer = threading.Thread(target=kill_then_give)
            killer.start()
            assert list(running) == [(0, "the answer")]
            killer.join()
        assert len(text_in(note).split()) == 2
    finally:
        for process in started:
            process.kill()
            process.wait()


def test_no_scheduler_there_is_said_with_what_to_do(monkeypatch):
    monkeypatch.setattr("sim_plant.fleet.cluster.ANSWER_S", 0.5)
    with pytest.raises(ClusterError, match="start one with `dask scheduler`"):
        Cluster(jobs.half, 1, scheduler="tcp://127.0.0.1:9", limit_s=LONG_S)


@pytest.fixture
def scheduler(tmp_path):
    """Start a scheduler without a worker; yield its address."""
    file = tmp_path / "scheduler.json"
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1"]
    words = [*dask, "--port", "0", "--no-dashboard", "--scheduler-file", str(file)]
    process = subprocess.Popen(words, stderr=subprocess.DEVNULL)
    try:
        yield json.loads(text_in(file))["address"]
    finally:
        process.kill()
        process.wait()


def test_a_first_worker_is_awaited_with_a_word_and_then_works(at_hand, monkeypatch):
    monkeypatch.setattr("sim_plant.fleet.cluster.SOON_S", 0.2)
    at_hand.scale(0)
    said = []

    def tell(text):
        said.append(text)
        at_hand.scale(1)

    address = at_hand.scheduler_address
    with Cluster(jobs.half, 0, scheduler=address, limit_s=LONG_S, tell=tell) as cluster:
        assert list(cluster.run([3])) == [(0, 1.5)]
    (text,) = said
    assert f"{address} has no worker yet; a first one is awaited for 120 s" in text


def test_a_worker_that_never_comes_is_said_with_what_to_do(scheduler, monkeypatch):
    monkeypatch.setattr("sim_plant.fleet.cluster.SOON_S", 0.2)
    monkeypatch.setattr("sim_plant.fleet.cluster.FIRST_WORKER_S", 0.3)
    with pytest.raises(ClusterError, match=r"no worker after 0\.3 s; start one with `dask worker"):
        Cluster(jobs.half, 0, scheduler=scheduler, limit_s=LONG_S)
