"""The recorder of the demo, killed in the middle: who is killed, and what is said to be lost."""

import os

import pytest

from aff_runtime.app.supervisor.recorder_child import RecorderChild
from aff_runtime.base.errors import PlantError
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.ring import RingReader, RingWriter
from sim_plant.demo.loop.recorder_kill import kill_recorder, loss_of
from tests.processes import until

pytestmark = pytest.mark.processes
STEP_S, CAPACITY, WRITTEN = 0.005, 256, 200


def test_a_service_without_a_recorder_is_told_so():
    with pytest.raises(PlantError, match=r"no recorder to kill; runtime\.log says why"):
        kill_recorder(os.getpid())


# quick of 0: refine/records/test_lossy_recorder.py, in time
@pytest.mark.parametrize("lost", [pytest.param(0, marks=pytest.mark.long), 40])
def test_what_a_killed_recorder_cost_is_told_by_the_rows(tmp_path, lost):
    ring = RingWriter(["time_s", "tick"], meta=RunMeta(start_ns=1), capacity=CAPACITY)
    reader = RingReader(ring.open_for_readers())
    first = RecorderChild(reader, tmp_path, RunContext(name="line"))
    write(ring, 0, WRITTEN)
    until("all is written", lambda: first.report().rows == WRITTEN)
    assert kill_recorder(os.getpid()) == first.pid
    until("it is dead", lambda: not first.report().alive)
    first.wait(0.0)
    meanwhile = WRITTEN + lost + CAPACITY - 1 if lost else WRITTEN + 100
    write(ring, WRITTEN, meanwhile)
    folder = first.report().folder
    context = RunContext(name="line", takes_over=folder, died=first.how_it_ended())
    second = RecorderChild(reader, tmp_path, context)
    until("it goes on", lambda: second.report().rows == meanwhile - WRITTEN - lost)
    write(ring, meanwhile, meanwhile + 100)
    ring.close()
    second.wait(60.0)
    reader.close()

    loss = loss_of(f"{folder}@0.1..")
    assert loss.at_s == pytest.approx((WRITTEN - 1) * STEP_S)
    assert (loss.ticks, loss.segment, loss.torn) == (lost, "signals-0001.csv.gz", True)
    assert loss.rows == WRITTEN - round(0.1 / STEP_S)
    assert loss.gone_s == pytest.approx((lost + 1) * STEP_S)
    assert loss.said[0] == "signals-0001.csv.gz: ends torn, its last row is whole"
    assert f"recorder {first.pid}: killed by SIGKILL" in loss.said[1]
    assert f"{lost} ticks lost" in str(loss)
    assert "signals-0001.csv.gz ends half-written, its 180 whole rows are read" in str(loss)
    with pytest.raises(PlantError, match="no recorder went on behind the one"):
        loss_of(f"{folder}@0..0.5")


def write(ring, first, end):
    for k in range(first, end):
        ring.write((k * STEP_S, float(k)))
