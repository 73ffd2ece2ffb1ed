"""Commands that a demo gives to the service."""

import signal
import subprocess
import sys
import time

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.demo.processes import Bench, runtime_command
from tests.processes import is_running

pytestmark = pytest.mark.processes


def test_a_command_that_is_not_answered_in_time_says_where_to_look(tmp_path):
    bench = Bench(folder=tmp_path, site=tmp_path / "site.yaml", plant_arguments=())
    with pytest.raises(PlantError, match=r"status: no answer within 0.01 s.*runtime\.log says"):
        runtime_command(bench, "status", patience_s=0.01)


@pytest.mark.parametrize("told", [signal.SIGTERM, signal.SIGHUP])
def test_whoever_is_told_to_end_takes_his_children_along(tmp_path, told):
    """As the command does: the handler, then a child in a `with`."""
    script = f"""
import sys, time
from pathlib import Path
from sim_plant.demo.processes import Child, end_as_by_hand
end_as_by_hand()
sleeper = [sys.executable, "-S", "-c", "import time; time.sleep(60)"]
with Child("plant", sleeper, Path({str(tmp_path / "log")!r})) as child:
    print(child.process.pid, flush=True)
    time.sleep(60)
"""
    command = [sys.executable, "-c", script]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as parent:
        pid = int(parent.stdout.readline())
        assert is_running(pid)
        parent.send_signal(told)
        assert parent.wait(20.0) != 0
    until = time.monotonic() + 5.0
    while is_running(pid) and time.monotonic() < until:
        time.sleep(0.02)
    assert not is_running(pid)
